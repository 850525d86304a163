; Status::of_raw, for three axes.
;@ function prove_of_raw

;@ claim flag: RAW_INVALID if and only if a gyro sample is NaN or infinite, and no other flag
(= |result|
  (ite (and (finite |raw.0|) (finite |raw.1|) (finite |raw.2|)) (_ bv0 16) (_ bv128 16)))
