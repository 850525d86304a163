; The lines of the valid ramp, in the units of the axes.
;@ define
; Where the ramp ends, and its slope per step.
(define-fun end_0 () F32 (number valid |ramps.ends.0.0| |ramps.ends.0.1|))
(define-fun end_1 () F32 (number valid |ramps.ends.1.0| |ramps.ends.1.1|))
(define-fun end_2 () F32 (number valid |ramps.ends.2.0| |ramps.ends.2.1|))
(define-fun slope_0 () F32 (number valid |ramps.slopes.0.0| |ramps.slopes.0.1|))
(define-fun slope_1 () F32 (number valid |ramps.slopes.1.0| |ramps.slopes.1.1|))
(define-fun slope_2 () F32 (number valid |ramps.slopes.2.0| |ramps.slopes.2.1|))
; The bias so many steps before the end.
(define-fun bias ((end F32) (slope F32) (steps (_ BitVec 32))) F32
  (fp.sub RNE end (fp.mul RNE ((_ to_fp_unsigned 8 24) RNE steps) slope)))
