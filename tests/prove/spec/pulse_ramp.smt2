; PulseRamp::new.
;@ function prove_pulse_ramp

;@ define
(define-fun c_15 () F32 ((_ to_fp 8 24) RNE 15.0))
(define-fun pulse () F32 ((_ to_fp 8 24) RNE 67108864.0))
(define-fun samples () (_ BitVec 16)
  (ite (bvuge |ramp.samples| (_ bv1 16)) |ramp.samples| (_ bv1 16)))
(define-fun count () F32 ((_ to_fp_unsigned 8 24) RNE samples))
(define-fun before ((end F32) (slope F32)) F32 (fp.sub RNE end (fp.mul RNE slope count)))
(define-fun not_below ((pulses F32)) F32
  (ite (fp.lt pulses (fp.neg c_15)) (fp.neg c_15) pulses))
(define-fun limited ((pulses F32)) F32
  (ite (fp.gt (not_below pulses) c_15) c_15 (not_below pulses)))
; A number in 2^-26 pulses: 0 of NaN, and at the ends of the range held there.
(define-fun word_of ((x F32)) (_ BitVec 32)
  (ite (fp.isNaN x) (_ bv0 32)
  (ite (fp.geq x ((_ to_fp 8 24) RNE 2147483648.0)) (_ bv2147483647 32)
  (ite (fp.leq x (fp.neg ((_ to_fp 8 24) RNE 2147483648.0))) (_ bv2147483648 32)
    ((_ fp.to_sbv 32) RTZ x)))))
(define-fun fixed ((pulses F32)) (_ BitVec 32)
  (word_of (fp.mul RNE (limited pulses) pulse)))
(define-fun exact ((x (_ BitVec 32))) (_ BitVec 64) ((_ sign_extend 32) x))
(define-fun most () (_ BitVec 32) (_ bv1006632960 32))
(define-fun bounded ((x (_ BitVec 32))) Bool (ticks_within x (bvneg most) most))
(define-fun end_0 () (_ BitVec 32) (fixed (fp.mul RNE |per_unit.0| |ramp.end.0|)))
(define-fun before_0 () (_ BitVec 32)
(fixed (fp.mul RNE |per_unit.0| (before |ramp.end.0| |ramp.slope.0|))))
(define-fun end_1 () (_ BitVec 32) (fixed (fp.mul RNE |per_unit.1| |ramp.end.1|)))
(define-fun before_1 () (_ BitVec 32)
(fixed (fp.mul RNE |per_unit.1| (before |ramp.end.1| |ramp.slope.1|))))
(define-fun end_2 () (_ BitVec 32) (fixed (fp.mul RNE |per_unit.2| |ramp.end.2|)))
(define-fun before_2 () (_ BitVec 32)
(fixed (fp.mul RNE |per_unit.2| (before |ramp.end.2| |ramp.slope.2|))))

; A way between two ends, its slope by a number of samples, and how far any gyro sample is from both.
(declare-const way (_ BitVec 32))
(declare-const slope (_ BitVec 32))
(declare-const to_end (_ BitVec 16))
(declare-const from_begin (_ BitVec 16))
(define-fun long ((x (_ BitVec 16))) (_ BitVec 64) ((_ zero_extend 48) x))
(define-fun all () (_ BitVec 64) (bvadd (long to_end) (long from_begin)))
(define-fun left_over () (_ BitVec 64) (bvsub (exact way) (bvmul (exact slope) all)))
; From 0 to the other number, which may be negative.
(define-fun between ((x (_ BitVec 64)) (end (_ BitVec 64))) Bool
  (ite (bvsge end (_ bv0 64))
    (and (bvsle (_ bv0 64) x) (bvsle x end)) (and (bvsle end x) (bvsle x (_ bv0 64)))))
; The same sign, and less than 2^47.
(define-fun signed_as ((x (_ BitVec 64)) (end (_ BitVec 64))) Bool
  (ite (bvsge end (_ bv0 64))
    (and (bvsle (_ bv0 64) x) (bvslt x (_ bv140737488355328 64)))
    (and (bvslt (bvneg (_ bv140737488355328 64)) x) (bvsle x (_ bv0 64)))))
; What division rounded towards zero means: quotient and remainder are 0 or have the sign of the
; dividend, and are no larger.
(define-fun divided () Bool
  (and (between (exact slope) (exact way)) (between left_over (exact way))))

;@ claim end: the end of the ramp in 2^-26 pulses, rounded towards zero, of at most 15 pulses, and 0 for NaN
(and
  (= |fixed'.end.0| end_0)
  (= |fixed'.end.1| end_1)
  (= |fixed'.end.2| end_2))

;@ claim bound: no end is beyond 15 pulses, and no beginning
(and
  (bounded |fixed'.end.0|) (bounded before_0)
  (bounded |fixed'.end.1|) (bounded before_1)
  (bounded |fixed'.end.2|) (bounded before_2))

;@ claim way: the way between the ends fits 32 bits
(and
  (= (exact (bvsub |fixed'.end.0| before_0)) (bvsub (exact |fixed'.end.0|) (exact before_0)))
  (= (exact (bvsub |fixed'.end.1| before_1)) (bvsub (exact |fixed'.end.1|) (exact before_1)))
  (= (exact (bvsub |fixed'.end.2| before_2)) (bvsub (exact |fixed'.end.2|) (exact before_2))))

;@ claim slope abstract: the slope is the way between the ends by the samples, rounded towards zero
(and
  (= |fixed'.slope.0| (bvsdiv (bvsub end_0 before_0) ((_ zero_extend 16) samples)))
  (= |fixed'.slope.1| (bvsdiv (bvsub end_1 before_1) ((_ zero_extend 16) samples)))
  (= |fixed'.slope.2| (bvsdiv (bvsub end_2 before_2) ((_ zero_extend 16) samples))))

;@ claim parts: of any such division, the ways before and after a gyro sample are the whole way of the slope
(= (bvmul (exact slope) all)
   (bvadd (bvmul (exact slope) (long to_end)) (bvmul (exact slope) (long from_begin))))

;@ claim signs slow: they have one direction, and do not overflow
(=> divided
  (and (signed_as (bvmul (exact slope) (long to_end)) (exact way))
       (signed_as (bvmul (exact slope) (long from_begin)) (exact way))))

;@ claim within by parts,signs: so no bias of a ramp lies beyond its ends
(=> divided (between (bvmul (exact slope) (long to_end)) (exact way)))

;@ claim rest: samples and flags are those of the ramp
(and (= |fixed'.samples| |ramp.samples|) (= |fixed'.status| |ramp.status|))
