/* Dimensions of a model file, for buffers that are static. Written by `capsule-rom header`. */

#ifndef CAPSULE_MODEL_H
#define CAPSULE_MODEL_H

/* CRC-32 of the content: capsule_description.digest */
#define CAPSULE_MODEL_DIGEST 0xda85bc28u

/* Version of the file format */
#define CAPSULE_MODEL_FORMAT_VERSION 10

/* Bytes of the file */
#define CAPSULE_MODEL_FILE_SIZE 873472

/* Constitutive law of the membrane */
#define CAPSULE_MODEL_LAW "neo-Hookean"

/* Parameters of a query */
#define CAPSULE_MODEL_PARAMETERS 2

/* The last instant, in the unit of time */
#define CAPSULE_MODEL_END_TIME 20.0f

/* Stored instants */
#define CAPSULE_MODEL_INSTANTS 56

/* Samples of all clusters */
#define CAPSULE_MODEL_SAMPLES 574

/* Modes of a field, the translation included: at most CAPSULE_MAX_MODES */
#define CAPSULE_MODEL_MODES 105

/* Local modes of the paper's method: at most CAPSULE_MAX_LOCAL_MODES */
#define CAPSULE_MODEL_LOCAL_MODES 16

/* Samples that take part in a query: at most CAPSULE_MAX_NEIGHBOURS */
#define CAPSULE_MODEL_NEIGHBOURS 15

/* Elements of the surface */
#define CAPSULE_MODEL_ELEMENTS 1352

/* Nodes of the surface: three numbers each in capsule_positions_at */
#define CAPSULE_MODEL_NODES 2706

/* Nodes that symmetry does not give: three numbers each in the scratch of capsule_membrane_at */
#define CAPSULE_MODEL_SECTOR_NODES 378

/* Points of CAPSULE_OUTLINE_MIDPLANE: two numbers each in capsule_outline_at */
#define CAPSULE_MODEL_MIDPLANE_POINTS 53

/* Points of CAPSULE_OUTLINE_DIAGONAL */
#define CAPSULE_MODEL_DIAGONAL_POINTS 27

#endif
