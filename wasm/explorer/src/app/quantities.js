/** The read-outs, by the names that they have in the JSON of `capsule-rom predict`. */
export const QUANTITIES = /** @type {const} */ ([
  "axial_length",
  "half_width",
  "half_diagonal",
  "rear_depth",
  "velocity",
  "volume",
  "expected_error",
  "error_bound",
]);
