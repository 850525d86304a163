; RampBuffer::publish. Steps are halves of gyro samples.
;@ function prove_publish

;@ define
(define-fun double ((x (_ BitVec 32))) (_ BitVec 32) (bvmul (_ bv2 32) x))
(define-fun new_samples () (_ BitVec 32) ((_ zero_extend 16) |ramp.samples|))
(define-fun new_head () (_ BitVec 32) (word other |ramps'.heads.0| |ramps'.heads.1|))
(define-fun is_early () Bool
  (and (distinct |ramp.samples| (_ bv0 16)) (bvsgt (left valid) samples)))
(define-fun half ((x F32)) F32 (fp.mul RNE x ((_ to_fp 8 24) RNE 0.5)))
; How often a word is stored: in the valid room never, in the other one once.
(define-fun never () (_ BitVec 16) (_ bv0 16))
(define-fun once () (_ BitVec 16) (_ bv1 16))
(define-fun stored ((first (_ BitVec 16)) (second (_ BitVec 16))) Bool
  (and (= (ite (= valid (_ bv0 32)) first second) never) (= (ite (= valid (_ bv0 32)) second first) once)))

;@ claim untouched: before the compiler's fence, each word of the other room is stored once, and neither the valid room nor the sequence number ever
(and
  (stored |before.ramps.left.0| |before.ramps.left.1|)
  (stored |before.ramps.heads.0| |before.ramps.heads.1|)
  (stored |before.ramps.ends.0.0| |before.ramps.ends.0.1|)
  (stored |before.ramps.ends.1.0| |before.ramps.ends.1.1|)
  (stored |before.ramps.ends.2.0| |before.ramps.ends.2.1|)
  (stored |before.ramps.slopes.0.0| |before.ramps.slopes.0.1|)
  (stored |before.ramps.slopes.1.0| |before.ramps.slopes.1.1|)
  (stored |before.ramps.slopes.2.0| |before.ramps.slopes.2.1|)
  (= |before.ramps.sequence| never))

;@ claim last: after the fence, the sequence number is stored once, and nothing else
(and
  (= |after.ramps.sequence| once)
  (= never
    |after.ramps.left.0| |after.ramps.left.1|
    |after.ramps.heads.0| |after.ramps.heads.1|
    |after.ramps.ends.0.0| |after.ramps.ends.0.1|
    |after.ramps.ends.1.0| |after.ramps.ends.1.1|
    |after.ramps.ends.2.0| |after.ramps.ends.2.1|
    |after.ramps.slopes.0.0| |after.ramps.slopes.0.1|
    |after.ramps.slopes.1.0| |after.ramps.slopes.1.1|
    |after.ramps.slopes.2.0| |after.ramps.slopes.2.1|))

;@ claim sequence: the sequence number counts on by one and wraps, so that the other room is the valid one
(and (= |ramps'.sequence| (bvadd |ramps.sequence| (_ bv1 32))) (= valid_after other))

;@ claim kept: what lies in the former room stays
(and (= (left_after valid) (left valid)) (= (line_after valid) (line valid)))

;@ claim whole: the new ramp lies in the other room: ends, half the slopes, samples, and twice as many steps left
(and
  (= (number other |ramps'.ends.0.0| |ramps'.ends.0.1|) |ramp.end.0|)
  (= (number other |ramps'.ends.1.0| |ramps'.ends.1.1|) |ramp.end.1|)
  (= (number other |ramps'.ends.2.0| |ramps'.ends.2.1|) |ramp.end.2|)
  (= (number other |ramps'.slopes.0.0| |ramps'.slopes.0.1|) (half |ramp.slope.0|))
  (= (number other |ramps'.slopes.1.0| |ramps'.slopes.1.1|) (half |ramp.slope.1|))
  (= (number other |ramps'.slopes.2.0| |ramps'.slopes.2.1|) (half |ramp.slope.2|))
  (= ((_ extract 15 0) new_head) |ramp.samples|)
  (= (left_after other) (double new_samples)))

;@ claim flag_interval: INTERVAL_INVALID is added if and only if the former ramp has more than half of its steps left and the new one has samples, and no other flag is
(= ((_ extract 31 16) new_head)
   (ite is_early (bvor |ramp.status| (_ bv16 16)) |ramp.status|))
