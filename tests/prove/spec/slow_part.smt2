; HistoryState::update for one second lag.
;@ function prove_slow_part

;@ define
(define-fun one () F32 ((_ to_fp 8 24) RNE 1.0))
(define-fun limit_c () F32 (fp.abs |slow_part.slow_parts.limit_c|))
; That of ThermalState::update.
(define-fun effective_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun filter_bound () F32 ((_ to_fp 8 24) RNE 137438953472.0))
(define-fun remainder_bound () F32 ((_ to_fp 8 24) RNE 8192.0))
(define-fun value () F32 |slow.slow_parts.value|)
(define-fun remainder () F32 |slow.slow_parts.remainder|)

;@ assume settings: what History::new accepts and derives
(and
  (within |slow_part.slow_parts.limit_c| zero ((_ to_fp 8 24) RNE 1000.0))
  (within |slow_part.per_tau_hz| ((_ to_fp 8 24) RNE 0.00001666) ((_ to_fp 8 24) RNE 10.0)))

;@ assume interval: what Interval::new makes (proved above)
(fp.leq zero |interval.dt_s|)

;@ assume temperature: what ThermalState::update yields
(within |effective_c| (fp.neg effective_bound) effective_bound)

;@ assume state: the invariant, which HistoryState::new establishes
(and
  (within value (fp.neg filter_bound) filter_bound)
  (within remainder (fp.neg remainder_bound) remainder_bound))

;@ define
(define-fun x () F32 (fp.mul RNE |slow_part.per_tau_hz| |interval.dt_s|))
(define-fun gap () Bool (fp.gt x ((_ to_fp 8 24) RNE 0.5)))
(define-fun series () F32
  (let ((half (fp.mul RNE x ((_ to_fp 8 24) RNE 0.5)))
        (third (fp.mul RNE x (fp.div RNE one ((_ to_fp 8 24) RNE 3.0)))))
    (fp.mul RNE x (fp.sub RNE one (fp.mul RNE half (fp.sub RNE one third))))))
(define-fun alpha () F32 (ite gap one series))
(define-fun lag_c () F32 (fp.sub RNE (fp.sub RNE |effective_c| value) remainder))
(define-fun increment () F32 (fp.add RNE remainder (fp.mul RNE lag_c alpha)))
(define-fun left_c () F32 (fp.mul RNE lag_c (fp.sub RNE one alpha)))

;@ claim alpha: the share is within 0 to 1
(within alpha zero one)

;@ claim lag: the lag is a number, and so is what is left of it
(and (finite lag_c) (finite left_c))

;@ claim equation abstract by alpha,lag: the filtered temperature and its remainder follow the documented equations
(and
  (same |slow'.slow_parts.value| (fp.add RNE value increment))
  (same |slow'.slow_parts.remainder|
    (fp.sub RNE increment (fp.sub RNE |slow'.slow_parts.value| value))))

;@ claim output abstract by lag: given is the lag that is left, or the nearest that was calibrated
(= |result|
  (ite (fp.gt left_c limit_c) limit_c
  (ite (fp.lt left_c (fp.neg limit_c)) (fp.neg limit_c) left_c)))

;@ claim gap: nothing is left of the lag after an interval of more than half the time constant
(=> gap (fp.isZero |result|))

;@ claim bound: the lag given is within what was calibrated
(within |result| (fp.neg limit_c) limit_c)

;@ claim finite: every part of the state is finite
(and (finite |slow'.slow_parts.value|) (finite |slow'.slow_parts.remainder|))

;@ claim kept_value: the invariant of the filtered temperature is kept
(within |slow'.slow_parts.value| (fp.neg filter_bound) filter_bound)

;@ claim kept_remainder slow: the invariant of the remainder is kept
(within |slow'.slow_parts.remainder| (fp.neg remainder_bound) remainder_bound)
