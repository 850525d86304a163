; SecondLag::update.
;@ function prove_second_lag

;@ define
(define-fun one () F32 ((_ to_fp 8 24) RNE 1.0))
; Of the conditioned temperature, slower than the part can.
(define-fun temp_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun filter_bound () F32 ((_ to_fp 8 24) RNE 137438953472.0))
(define-fun remainder_bound () F32 ((_ to_fp 8 24) RNE 8192.0))
(define-fun value () F32 |lag.filtered.value|)
(define-fun remainder () F32 |lag.filtered.remainder|)
(define-fun alpha () F32 |interval.alpha2|)

;@ assume interval: what Interval::new makes (proved above)
(within alpha zero one)

;@ assume temperature: what SecondLagState::update makes
(within |temp_c| (fp.neg temp_bound) temp_bound)

;@ assume state: the invariant, which SecondLag::new establishes
(and
  (within value (fp.neg filter_bound) filter_bound)
  (within remainder (fp.neg remainder_bound) remainder_bound))

;@ define
(define-fun lag_c () F32 (fp.sub RNE (fp.sub RNE |temp_c| value) remainder))
(define-fun increment () F32 (fp.add RNE remainder (fp.mul RNE lag_c alpha)))
(define-fun left_c () F32 (fp.mul RNE lag_c (fp.sub RNE one alpha)))

;@ claim lag: the lag is a number, and so is what is left of it
(and (finite lag_c) (finite left_c))

;@ claim equation abstract by lag: the filtered temperature and its remainder follow the documented equations
(and
  (same |lag'.filtered.value| (fp.add RNE value increment))
  (same |lag'.filtered.remainder|
    (fp.sub RNE increment (fp.sub RNE |lag'.filtered.value| value))))

;@ claim output: given is the lag that is left
(same |result| left_c)

;@ claim gap: nothing is left of the lag where the share is 1
(=> (fp.eq alpha one) (fp.isZero |result|))

;@ claim finite: every part of the state is finite
(and (finite |lag'.filtered.value|) (finite |lag'.filtered.remainder|))

;@ claim kept_value: the invariant of the filtered temperature is kept
(within |lag'.filtered.value| (fp.neg filter_bound) filter_bound)

;@ claim kept_remainder slow: the invariant of the remainder is kept
(within |lag'.filtered.remainder| (fp.neg remainder_bound) remainder_bound)
