/* The model file, on a 16-byte boundary: MODEL is its path. */
    .section .model, "a"
    .balign 16
    .global capsule_file
capsule_file:
    .incbin MODEL
    .global capsule_file_end
capsule_file_end:
