; ThermalState::update: conditioner, rate estimator, second lag, plays and all that follows.
;@ function prove_update

;@ define
; The constants as they are in f32.
(define-fun c_low () F32 (fp.neg ((_ to_fp 8 24) RNE 273.15)))
(define-fun c_1e3 () F32 ((_ to_fp 8 24) RNE 1000.0))
(define-fun c_1e4 () F32 ((_ to_fp 8 24) RNE 10000.0))
(define-fun c_milli () F32 ((_ to_fp 8 24) RNE 0.001))
(define-fun c_100 () F32 ((_ to_fp 8 24) RNE 100.0))
(define-fun c_200 () F32 ((_ to_fp 8 24) RNE 200.0))
(define-fun filter_bound () F32 ((_ to_fp 8 24) RNE 137438953472.0))
(define-fun remainder_bound () F32 ((_ to_fp 8 24) RNE 8192.0))
(define-fun moving_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun increment_bound () F32 ((_ to_fp 8 24) RNE 206158430208.0))
(define-fun one () F32 ((_ to_fp 8 24) RNE 1.0))
(define-fun two () F32 ((_ to_fp 8 24) RNE 2.0))
(define-fun memory_bound () F32 ((_ to_fp 8 24) RNE 67108864.0))
(define-fun memory_rest () F32 ((_ to_fp 8 24) RNE 4.0))
(define-fun gain_most () F32 ((_ to_fp 8 24) RNE 128.0))
(define-fun temp_bound () F32 ((_ to_fp 8 24) RNE 2048.0))
; f32::MAX.
(define-fun any_c () F32 (fp #b0 #xfe #b11111111111111111111111))
; Magnitudes that are kept as bits.
(define-fun reach_of_sensor_c () F32 ((_ to_fp 8 24) |thermal.sensor_reach|))
(define-fun slew_c () F32 ((_ to_fp 8 24) |interval.slew|))
(define-fun near_c () F32 ((_ to_fp 8 24) |interval.near|))
(define-fun fade () F32 ((_ to_fp 8 24) |interval.fade|))
(define-fun width1_c () F32 ((_ to_fp 8 24) |thermal.half_widths.0|))
(define-fun width2_c () F32 ((_ to_fp 8 24) |thermal.half_widths.1|))
(define-fun forward () Bool (not (fp.isInfinite |interval.gate_c|)))
; There is a second lag.
(define-fun has_lag2 () Bool
  (or (fp.lt |thermal.settings.lag2_min_c| zero) (fp.gt |thermal.settings.lag2_max_c| zero)))
(define-fun around ((x F32) (most F32)) Bool (within x (fp.neg most) most))
(define-fun holds ((sign (_ BitVec 32))) Bool (bvslt sign (_ bv0 32)))
; `way`, but no further than `most`.
(define-fun limited ((way F32) (most F32)) F32
  (ite (fp.gt way most) most (ite (fp.lt way (fp.neg most)) (fp.neg most) way)))
(define-fun clamped ((x F32) (low F32) (high F32)) F32
  (ite (fp.lt x low) low (ite (fp.gt x high) high x)))

;@ assume settings: what Thermal::new accepts and derives
(and
  (within |thermal.sensor_middle_c| c_low c_1e3)
  (within reach_of_sensor_c zero ((_ to_fp 8 24) RNE 640.0))
  (bvsle (_ bv0 32) |thermal.sensor_reach|)
  (within |thermal.settings.spike_gate_c| c_milli c_1e3)
  (within |thermal.settings.rate_min_c_per_min| (fp.neg c_1e4) zero)
  (within |thermal.settings.rate_max_c_per_min| zero c_1e4)
  (within |thermal.settings.reference_c| c_low c_1e3)
  (within |thermal.slew_c_per_tick| ((_ to_fp 8 24) RNE 0.00000000016)
    ((_ to_fp 8 24) RNE 0.001667))
  (within |thermal.least_memory| ((_ to_fp 8 24) RNE 0.00999) one)
  (within |thermal.shift_min| zero c_200)
  (within |thermal.tau_min| zero c_100)
  (within |thermal.settings.rate_start| zero c_100)
  (ticks_within |thermal.hold_ticks| (_ bv0 32) (_ bv2000000000 32))
  (ticks_within |thermal.healing| (bvneg (_ bv2000000000 32)) (_ bv0 32))
  (ticks_within |thermal.settling| (bvneg (_ bv2000000000 32)) (bvneg (_ bv1 32)))
  (ticks_within |thermal.restart_ticks| (_ bv1 32) (_ bv2000000000 32)))

;@ assume history: the same of the second lag and the plays
(and
  (around |thermal.settings.kappa2| two)
  (within |thermal.settings.lag2_min_c| (fp.neg c_1e3) zero)
  (within |thermal.settings.lag2_max_c| zero c_1e3)
  (= |thermal.lag2_flag| (ite has_lag2 (_ bv256 16) (_ bv0 16)))
  (around |thermal.play_shift_min| c_200)
  (around |thermal.settings.play_kappa2| two)
  (around |thermal.settings.lag2_start_min| c_1e3)
  (around |thermal.settings.play_start_min| c_1e3)
  (bvsle (_ bv0 32) |thermal.half_widths.0|)
  (bvsle (_ bv0 32) |thermal.half_widths.1|)
  (within width1_c zero c_1e3)
  (within width2_c zero c_1e3)
  (ticks_within |thermal.known_ticks| (_ bv0 32) (_ bv2000000000 32))
  (within |thermal.known_c| zero ((_ to_fp 8 24) RNE 2000.0)))

;@ assume interval: what Interval::new makes (proved)
(and
  (bvsle (_ bv0 32) |interval.ticks|)
  (within |interval.alpha| zero one)
  (within |interval.alpha2| zero one)
  (within |interval.rate_gain_per_min| zero ((_ to_fp 8 24) RNE 601.0))
  (bvsle (_ bv0 32) |interval.fade|)
  (fp.leq zero fade)
  (bvsle (_ bv0 32) |interval.slew|)
  (within slew_c zero ((_ to_fp 8 24) RNE 500001.0))
  (or (= |interval.gate_c| |thermal.settings.spike_gate_c|) (= |interval.gate_c| (_ -oo 8 24)))
  (= near_c (fp.add RNE |interval.gate_c| slew_c))
  (= (bvand |interval.status| (bvnot (_ bv16 16))) (_ bv0 16)))

;@ define
(define-fun filter_invariant ((value F32) (remainder F32)) Bool
  (and (around value filter_bound) (around remainder remainder_bound)))
(define-fun memory_invariant ((value F32) (remainder F32)) Bool
  (and (around value memory_bound) (around remainder memory_rest)))
(define-fun plays_invariant ((drag_c F32) (first_c F32) (second_c F32) (since (_ BitVec 32))
                             (low_c F32) (high_c F32)) Bool
  (and
    (around drag_c moving_bound)
    (within first_c (fp.sub RNE drag_c width1_c) (fp.add RNE drag_c width1_c))
    (within second_c (fp.sub RNE drag_c width2_c) (fp.add RNE drag_c width2_c))
    (bvsle (_ bv0 32) since)
    (within low_c (fp.neg any_c) drag_c)
    (within high_c drag_c any_c)))

;@ assume state: the invariant, which ThermalState::new and start establish
(and
  (around |state.conditioner.temp_c| temp_bound)
  (around |state.conditioner.anchor_c| temp_bound)
  (bvsle (_ bv0 32) |state.conditioner.age|)
  (filter_invariant |state.estimator.filtered.value| |state.estimator.filtered.remainder|)
  (filter_invariant |state.second.lag.filtered.value| |state.second.lag.filtered.remainder|)
  (around |state.second.temp_c| temp_bound)
  (around |state.effective_c| moving_bound)
  (within |state.weight| zero one))

;@ assume memory: the invariant of the estimator's memory
(memory_invariant |state.estimator.memory.value| |state.estimator.memory.remainder|)

;@ assume gain: that of its gain
(within |state.estimator.gain| one gain_most)

;@ assume plays: the one of the plays
(plays_invariant |state.plays.drag_c| |state.plays.plays.0.contact_c|
  |state.plays.plays.1.contact_c| |state.plays.since_loss| |state.plays.low_c|
  |state.plays.high_c|)

;@ define
; What the documentation says, in its own words. First what is accepted.
(define-fun in_range () Bool
  (fp.leq (fp.abs (fp.sub RNE |temp_c| |thermal.sensor_middle_c|)) reach_of_sensor_c))
(define-fun spec_age () (_ BitVec 32) (sum |state.conditioner.age| |interval.ticks|))
(define-fun was_lost () Bool (bvsgt |state.conditioner.age| |thermal.hold_ticks|))
(define-fun was_none () Bool (= |state.conditioner.age| (_ bv2147483647 32)))
(define-fun reach_c () F32 (fp.mul RNE |thermal.slew_c_per_tick| ((_ to_fp 8 24) RNE spec_age)))
(define-fun far_c () F32 (fp.add RNE |interval.gate_c| reach_c))
(define-fun change_c () F32 (fp.sub RNE |temp_c| |state.conditioner.temp_c|))
(define-fun off_c () F32 (fp.sub RNE |temp_c| |state.conditioner.anchor_c|))
(define-fun reachable () Bool (fp.leq (fp.abs off_c) far_c))
(define-fun plausible () Bool
  (ite was_lost (fp.leq (fp.abs change_c) near_c)
    (and reachable (fp.leq (fp.abs change_c) far_c))))
(define-fun accepted () Bool (and in_range plausible))
(define-fun fresh () Bool
  (or (fp.gt (fp.abs change_c) near_c) (bvsgt spec_age |thermal.restart_ticks|)))
(define-fun restart () Bool (and accepted fresh))
(define-fun first () Bool (and was_none accepted))
(define-fun lost () Bool (bvsgt |state'.conditioner.age| |thermal.hold_ticks|))
(define-fun unseen () Bool (bvsgt spec_age |thermal.hold_ticks|))
; The update in which rate, second lag and plays are put.
(define-fun starts () Bool
  (and (holds |state.starting|) (not (holds |state'.starting|)) (not lost)))
; A reading that is not accepted is gone on with only once the temperature is lost.
(define-fun taken () Bool (and in_range (or plausible lost)))
(define-fun anchor_slew_c () F32 (ite (fp.gt reach_c slew_c) reach_c slew_c))
; Then jumps: one is noticed, and seen in the end if a temperature away from the anchor is accepted.
(define-fun jumping () Bool
  (or (holds |state.conditioner.is_jumping|)
      (and in_range forward (not reachable) (not was_none))))
(define-fun seen () Bool (and jumping accepted (fp.gt (fp.abs off_c) near_c)))
(define-fun is_back () Bool (and was_lost in_range forward reachable))
; The rate.
(define-fun filtered () F32
  (ite (and taken fresh) (fp.add RNE change_c |state.estimator.filtered.value|)
    |state.estimator.filtered.value|))
(define-fun lag_c () F32
  (fp.sub RNE (fp.sub RNE |state'.conditioner.temp_c| filtered)
    |state.estimator.filtered.remainder|))
(define-fun increment () F32
  (fp.add RNE |state.estimator.filtered.remainder| (fp.mul RNE |interval.alpha| lag_c)))
(define-fun memory_lag () F32
  (fp.sub RNE (fp.sub RNE one |state.estimator.memory.value|)
    |state.estimator.memory.remainder|))
(define-fun memory_increment () F32
  (fp.add RNE |state.estimator.memory.remainder| (fp.mul RNE |interval.alpha| memory_lag)))
(define-fun memory () F32 (fp.add RNE |state.estimator.memory.value| memory_increment))
(define-fun shared () F32
  (ite (fp.gt memory |thermal.least_memory|) memory |thermal.least_memory|))
; One step of Newton's method for its reciprocal.
(define-fun newton () F32
  (fp.mul RNE |state.estimator.gain|
    (fp.sub RNE two (fp.mul RNE |state.estimator.gain| shared))))
(define-fun spec_rate () F32
  (fp.mul RNE (fp.mul RNE lag_c |interval.rate_gain_per_min|) |state'.estimator.gain|))
(define-fun in_limits ((rate F32)) F32
  (clamped rate |thermal.settings.rate_min_c_per_min| |thermal.settings.rate_max_c_per_min|))
(define-fun found_rate () F32 (in_limits spec_rate))
(define-fun put_rate () F32 (fp.mul RNE |thermal.settings.rate_start| found_rate))
(define-fun rate () F32 (ite starts (in_limits put_rate) found_rate))
(define-fun put_filtered () F32
  (fp.sub RNE |state'.conditioner.temp_c| (fp.mul RNE |thermal.tau_min| rate)))
; The second lag.
(define-fun way2_c () F32 (fp.sub RNE |state'.conditioner.temp_c| |state.second.temp_c|))
(define-fun slew2_c () F32 (ite first (_ +oo 8 24) slew_c))
(define-fun alpha2 () F32 (ite first one (ite lost zero |interval.alpha2|)))
(define-fun lag2_c () F32
  (fp.sub RNE (fp.sub RNE |state'.second.temp_c| |state.second.lag.filtered.value|)
    |state.second.lag.filtered.remainder|))
(define-fun increment2 () F32
  (fp.add RNE |state.second.lag.filtered.remainder| (fp.mul RNE alpha2 lag2_c)))
(define-fun start2_c () F32 (fp.mul RNE |thermal.settings.lag2_start_min| rate))
(define-fun put_filtered2 () F32 (fp.sub RNE |state'.second.temp_c| start2_c))
(define-fun spec_lag2 () F32
  (ite starts start2_c (fp.mul RNE (fp.sub RNE one alpha2) lag2_c)))
(define-fun lag2 () F32
  (clamped spec_lag2 |thermal.settings.lag2_min_c| |thermal.settings.lag2_max_c|))
; Where the lag-compensated temperature goes, and what drags the plays.
(define-fun target_c () F32
  (ite lost |thermal.settings.reference_c|
    (fp.sub RNE (fp.sub RNE |state'.conditioner.temp_c| (fp.mul RNE rate |thermal.shift_min|))
      (fp.mul RNE |thermal.settings.kappa2| lag2))))
(define-fun way_c () F32 (fp.sub RNE target_c |state.effective_c|))
(define-fun drag_target_c () F32
  (fp.sub RNE
    (fp.sub RNE |state'.conditioner.temp_c| (fp.mul RNE rate |thermal.play_shift_min|))
    (fp.mul RNE lag2 |thermal.settings.play_kappa2|)))
(define-fun drag_way_c () F32 (fp.sub RNE drag_target_c |state.plays.drag_c|))
; The plays.
(define-fun start_c () F32 (fp.mul RNE rate |thermal.settings.play_start_min|))
(define-fun slew_play_c () F32 (ite (or starts first) (_ +oo 8 24) slew_c))
(define-fun least_c ((width_c F32)) F32 (fp.sub RNE |state'.plays.drag_c| width_c))
(define-fun most_c ((width_c F32)) F32 (fp.add RNE |state'.plays.drag_c| width_c))
(define-fun contact ((contact_c F32) (width_c F32)) F32
  (let ((from (ite (or starts first) (fp.sub RNE |state'.plays.drag_c| (limited start_c width_c))
                contact_c)))
  (let ((at_least (ite (fp.lt from (least_c width_c)) (least_c width_c) from)))
    (ite (fp.gt at_least (most_c width_c)) (most_c width_c) at_least))))
(define-fun behind1_c () F32 (fp.sub RNE |state'.plays.drag_c| |state'.plays.plays.0.contact_c|))
(define-fun behind2_c () F32 (fp.sub RNE |state'.plays.drag_c| |state'.plays.plays.1.contact_c|))
; How far the past is known.
(define-fun early ((since (_ BitVec 32))) Bool (bvslt since (bvneg |thermal.settling|)))
(define-fun waits () Bool
  (and (early |state.plays.since_loss|) (not (fp.leq (fp.abs drag_way_c) slew_play_c))))
(define-fun target_weight () F32 (ite lost zero one))
(define-fun weight_way () F32 (fp.sub RNE target_weight |state.weight|))

;@ claim reach: what the part can have moved is a number
(and (finite reach_c) (not (fp.isNegative reach_c)))

;@ claim far by reach: the gate in effect is a number and positive, or nothing passes without time
(ite forward (and (finite far_c) (fp.leq c_milli far_c)) (= far_c (_ -oo 8 24)))

;@ claim near: so is the gate between two readings
(ite forward (fp.leq c_milli near_c) (= near_c (_ -oo 8 24)))

;@ claim change: the change of a temperature in range is a number, and so is its way from the anchor
(=> in_range (and (finite change_c) (finite off_c)))

;@ claim age abstract by far,near,change: accepted if the part can have reached it from the last accepted one and from the anchor, once lost if it agrees with the reading before; ticks since then
(= |state'.conditioner.age| (ite accepted (_ bv0 32) spec_age))

;@ claim belief abstract by far,near,change: the temperature is taken if accepted or to be confirmed, else it is what it was, NaN and infinite included
(= |state'.conditioner.temp_c| (ite taken |temp_c| |state.conditioner.temp_c|))

;@ claim held abstract by age,belief: what is not accepted leaves the last accepted one as it was until that is lost
(=> (and (not accepted) (not lost)) (= |state'.conditioner.temp_c| |state.conditioner.temp_c|))

;@ claim anchor abstract by reach,far,near,change: the anchor follows accepted temperatures only, and by no more than the part can have moved, but for a return after a loss
(same |state'.conditioner.anchor_c|
  (ite (not accepted) |state.conditioner.anchor_c|
  (ite was_lost |temp_c|
    (fp.add RNE |state.conditioner.anchor_c| (limited off_c anchor_slew_c)))))

;@ claim settling abstract by far,near,change: begins at a restart, is extended by rejections and else runs down
(let ((healing (difference |thermal.healing| |state.conditioner.age|)))
  (= |state'.conditioner.settled|
    (ite restart |thermal.settling|
    (ite accepted (sum |state.conditioner.settled| |interval.ticks|)
    (ite (bvslt |state.conditioner.settled| healing) |state.conditioner.settled| healing)))))

;@ claim counters abstract by far,near,change: rejections and restarts are counted, each by one
(and
  (= |state'.conditioner.rejected|
    (bvadd |state.conditioner.rejected| (ite accepted (_ bv0 32) (_ bv1 32))))
  (= |state'.conditioner.restarts|
    (bvadd |state.conditioner.restarts| (ite restart (_ bv1 32) (_ bv0 32)))))

;@ claim jumping abstract by far,near,change: a reading that the part cannot have reached is remembered until one is accepted, or one that it can have reached comes while lost
(= (holds |state'.conditioner.is_jumping|) (and jumping (not accepted) (not is_back)))

;@ claim jumped abstract by far,near,change: a jump counts once a temperature away from the anchor is accepted after it, and then lasts
(= (holds |state'.conditioner.has_jumped|) (or (holds |state.conditioner.has_jumped|) seen))

;@ claim flag_invalid abstract by far,near,change: TEMPERATURE_INVALID if and only if NaN or out of the sensor's range
(= (flag |status'.value| (_ bv1 16)) (not in_range))

;@ claim flag_spike abstract by far,near,change: TEMPERATURE_SPIKE if and only if in range and not plausible, though time has passed
(= (flag |status'.value| (_ bv2 16)) (and in_range (not plausible) forward))

;@ claim flag_lost abstract: TEMPERATURE_LOST if and only if the age exceeds the hold time
(= (flag |status'.value| (_ bv4 16)) lost)

;@ claim flag_jumped abstract: TEMPERATURE_JUMPED if and only if a jump counts
(= (flag |status'.value| (_ bv1024 16)) (holds |state'.conditioner.has_jumped|))

;@ claim flag_interval abstract: INTERVAL_INVALID follows the interval, and no flag without a meaning is ever set
(= (bvand |status'.value| (bvnot (_ bv1871 16))) |interval.status|)

;@ claim memory_equation abstract: the share of the memory follows the equations of the filter, for a step to 1; at the start it is 1
(and
  (same |state'.estimator.memory.value| (ite starts one memory))
  (same |state'.estimator.memory.remainder|
    (fp.sub RNE memory_increment (fp.sub RNE memory |state.estimator.memory.value|))))

;@ claim gain_equation abstract: a step of Newton's method, and at least 1
(= |state'.estimator.gain| (ite (fp.gt newton one) newton one))

;@ claim no_correction alone by gain_equation: with a time constant of 60 s or less, a gain of 1 stays
(=> (and (= |thermal.least_memory| one) (= |state.estimator.gain| one))
    (= |state'.estimator.gain| one))

;@ claim kept_gain alone by gain_equation: the invariant of the gain is kept
(within |state'.estimator.gain| one gain_most)

;@ claim filter_equation abstract by far,near,change: the filtered temperature and its remainder follow the documented equations; at the start it is put where a lasting ramp has it
(and
  (same |state'.estimator.filtered.value| (ite starts put_filtered (fp.add RNE filtered increment)))
  (same |state'.estimator.filtered.remainder|
    (fp.sub RNE increment (fp.sub RNE (fp.add RNE filtered increment) filtered))))

;@ claim kept: the invariant of temperature and times is kept
(and (around |state'.conditioner.temp_c| temp_bound)
     (bvsle (_ bv0 32) |state'.conditioner.age|)
     (bvsle (_ bv0 32) |state'.plays.since_loss|))

;@ claim temperature alone: one in range is within the bound, and so is its way from the anchor
(=> in_range (and (around |temp_c| temp_bound) (around off_c ((_ to_fp 8 24) RNE 4096.0))))

;@ claim kept_anchor free plausible,reach_c by temperature,reach,anchor: the invariant of the anchor is kept
(around |state'.conditioner.anchor_c| temp_bound)

;@ claim shifted free plausible,fresh,lost by temperature: the filtered temperature that goes on from a jump is within the bound
(around filtered filter_bound)

;@ claim lag free filtered by kept,shifted: the lag of the rate estimator is a number
(around lag_c increment_bound)

;@ claim rate free lag_c by kept_gain,lag: the rate is a number before it is limited
(finite spec_rate)

;@ claim flag_rate abstract by far,near,change,rate: RATE_CLAMPED if and only if the rate left its range
(= (flag |status'.value| (_ bv64 16))
   (or (fp.lt spec_rate |thermal.settings.rate_min_c_per_min|)
       (fp.gt spec_rate |thermal.settings.rate_max_c_per_min|)))

;@ claim found_range free spec_rate by rate: the rate that is found is the nearest in range
(within found_rate |thermal.settings.rate_min_c_per_min| |thermal.settings.rate_max_c_per_min|)

;@ claim put_rate free found_rate by found_range: the one of a lasting ramp is a number before it is limited
(finite put_rate)

;@ claim rate_range free found_rate,put_rate by found_range,put_rate: the rate, put at the start, is the nearest in range
(within rate |thermal.settings.rate_min_c_per_min| |thermal.settings.rate_max_c_per_min|)

;@ claim way2 alone by kept: the way of what the second lag follows is a number
(finite way2_c)

;@ claim second abstract by far,near,change,way2: it moves no further than the slew, but to the first temperature of all at once, and stands still while lost
(same |state'.second.temp_c|
  (ite lost |state.second.temp_c|
    (fp.add RNE |state.second.temp_c| (limited way2_c slew2_c))))

;@ claim kept_second free lost,first by kept,second: its invariant is kept
(around |state'.second.temp_c| temp_bound)

;@ claim second_equation abstract by far,near,change: its filter follows the documented equations, with a share of 0 while lost and of 1 at the first temperature of all; at the start it is put where a lasting ramp has it
(let ((filtered2 (fp.add RNE |state.second.lag.filtered.value| increment2)))
(and
  (same |state'.second.lag.filtered.value| (ite starts put_filtered2 filtered2))
  (same |state'.second.lag.filtered.remainder|
    (fp.sub RNE increment2 (fp.sub RNE filtered2 |state.second.lag.filtered.value|)))))

;@ claim alpha2 free first,lost: its share is within 0 to 1
(within alpha2 zero one)

;@ claim start2 free rate by rate_range: where the second lag starts is a number
(around start2_c ((_ to_fp 8 24) RNE 10000000.0))

;@ claim lag2 free alpha2,start2_c by kept_second,alpha2,start2: the second lag is a number before it is limited
(and (around lag2_c increment_bound) (finite spec_lag2))

;@ claim flag_lag abstract by far,near,change,lag2: LAG_CLAMPED if and only if there is a second lag and it left its range
(= (flag |status'.value| (_ bv256 16))
   (and has_lag2 (or (fp.lt spec_lag2 |thermal.settings.lag2_min_c|)
                     (fp.gt spec_lag2 |thermal.settings.lag2_max_c|))))

;@ claim lag2_range free spec_lag2 by lag2: the second lag is the nearest in range
(within lag2 |thermal.settings.lag2_min_c| |thermal.settings.lag2_max_c|)

;@ claim weight_way alone: the way of the weight is a number
(finite weight_way)

;@ claim weight abstract by weight_way: the weight of rate and history moves towards 0 while lost, else towards 1, by no more than the interval's share of 60 s
(same |state'.weight| (fp.add RNE |state.weight| (limited weight_way fade)))

;@ claim kept_weight free lost by weight: its invariant is kept, and it gets to exactly 0 and 1
(and (within |state'.weight| zero one)
  (=> (fp.leq (fp.abs weight_way) fade) (fp.eq |state'.weight| target_weight)))

;@ claim target free lost,rate,lag2 by kept,rate_range,lag2_range: the target is within the bound
(around target_c moving_bound)

;@ claim way free target_c by target: the way to the target is a number
(finite way_c)

;@ claim slew abstract by far,near,change,way: the lag-compensated temperature moves towards its target, the reference temperature while lost, by a step of the slew at most, rounded once
(same |state'.effective_c| (fp.add RNE |state.effective_c| (limited way_c slew_c)))

;@ claim kept_effective free target_c by target,slew: the invariant of the lag-compensated temperature is kept
(around |state'.effective_c| moving_bound)

;@ claim starting abstract: the time to the start runs on
(= |state'.starting| (sum |state.starting| |interval.ticks|))

;@ claim flag_settling abstract by far,near,change,way: SETTLING if and only if settling, further from the target than the gate and the slew, of less than full weight, or before the start
(= (flag |status'.value| (_ bv8 16))
   (or (holds |state'.conditioner.settled|)
       (not (fp.leq (fp.abs way_c) near_c))
       (fp.lt (fp.abs |state'.weight|) one)
       (holds |state'.starting|)))

;@ claim drag_target free rate,lag2 by kept,rate_range,lag2_range: where what drags the plays is to go is within the bound
(around drag_target_c moving_bound)

;@ claim drag_way free drag_target_c by drag_target: its way there is a number
(finite drag_way_c)

;@ claim drag abstract by far,near,change,drag_way: it moves no further than the slew, but at the start and to the first temperature of all at once, and stands still while lost
(same |state'.plays.drag_c|
  (ite lost |state.plays.drag_c|
    (fp.add RNE |state.plays.drag_c| (limited drag_way_c slew_play_c))))

;@ claim kept_drag free drag_target_c,lost,first by drag_target,drag: its invariant is kept
(around |state'.plays.drag_c| moving_bound)

;@ claim start_play free rate by rate_range: where a play starts is a number
(finite start_c)

;@ claim contact1 abstract by far,near,change,start_play: the contact of the first play is dragged along; at the start, and at the first temperature of all, it is put where the rate says, within the half width
(same |state'.plays.plays.0.contact_c| (contact |state.plays.plays.0.contact_c| width1_c))

;@ claim contact2 abstract by far,near,change,start_play: so is the second one's
(same |state'.plays.plays.1.contact_c| (contact |state.plays.plays.1.contact_c| width2_c))

;@ claim kept_play1 free starts,first,start_c by kept_drag,contact1,start_play: its contact is no further than its half width, rounded
(within |state'.plays.plays.0.contact_c| (least_c width1_c) (most_c width1_c))

;@ claim kept_play2 free starts,first,start_c by kept_drag,contact2,start_play: so is the second one's
(within |state'.plays.plays.1.contact_c| (least_c width2_c) (most_c width2_c))

;@ claim frozen abstract by far,near,change,second,drag,contact1,contact2: while lost, contacts, what drags them and what the second lag follows stand still
(=> lost (and
  (same |state'.plays.plays.0.contact_c| |state.plays.plays.0.contact_c|)
  (same |state'.plays.plays.1.contact_c| |state.plays.plays.1.contact_c|)
  (same |state'.plays.drag_c| |state.plays.drag_c|)
  (same |state'.second.temp_c| |state.second.temp_c|)))

;@ claim frozen_lag free in_range,plausible by second_equation,lag2,age: while lost, the filter of the second lag stands still, if its remainder is what rounding left out
(=> (and lost (fp.eq (fp.add RNE |state.second.lag.filtered.value|
                             |state.second.lag.filtered.remainder|)
                     |state.second.lag.filtered.value|))
  (and
    (fp.eq |state'.second.lag.filtered.value| |state.second.lag.filtered.value|)
    (fp.eq |state'.second.lag.filtered.remainder| |state.second.lag.filtered.remainder|)))

;@ claim since abstract by drag_way,far,near,change: time since the loss: none until after the return, and as long as the rate settles it only counts while what drags the plays follows
(= |state'.plays.since_loss|
  (ite unseen (_ bv0 32)
    (sum |state.plays.since_loss| (ite waits (_ bv0 32) |interval.ticks|))))

;@ claim range abstract: what drags the plays since the rate has settled, at its lowest and highest
(and
  (same |state'.plays.low_c|
    (ite (or (early |state'.plays.since_loss|) (fp.lt |state'.plays.drag_c| |state.plays.low_c|))
      |state'.plays.drag_c| |state.plays.low_c|))
  (same |state'.plays.high_c|
    (ite (or (early |state'.plays.since_loss|) (fp.gt |state'.plays.drag_c| |state.plays.high_c|))
      |state'.plays.drag_c| |state.plays.high_c|)))

;@ claim kept_range alone by kept_drag,range: its invariant is kept
(and (within |state'.plays.low_c| (fp.neg any_c) |state'.plays.drag_c|)
     (within |state'.plays.high_c| |state'.plays.drag_c| any_c))

;@ claim flag_history abstract: HISTORY_UNKNOWN if and only if not moved through the wider play since then, or not three time constants of the second lag since the loss
(= (flag |status'.value| (_ bv512 16))
   (or (fp.lt (fp.sub RNE |state'.plays.high_c| |state'.plays.low_c|) |thermal.known_c|)
       (bvslt |state'.plays.since_loss| |thermal.known_ticks|)))

;@ claim history_lost free waits by since,kept_drag,range,kept_range,flag_history: it is set with the loss, and not without second lag and plays
(ite (or (fp.gt |thermal.known_c| zero) (bvsgt |thermal.known_ticks| (_ bv0 32)))
  (=> unseen (flag |status'.value| (_ bv512 16)))
  (not (flag |status'.value| (_ bv512 16))))

;@ claim output abstract: the lag-compensated temperature given is the one that is kept
(same |effective_c'.value| |state'.effective_c|)

;@ claim output_rate abstract by far,near,change: the rate given is the one in range, times the weight
(same |rate_c_per_min'.value| (fp.mul RNE rate |state'.weight|))

;@ claim output_lag abstract by far,near,change: the second lag given is the one in range, times the weight
(same |lag2_c'.value| (fp.mul RNE lag2 |state'.weight|))

;@ claim output_play1 abstract: what the first play is behind is given times the weight
(same |play1_c'.value| (fp.mul RNE |state'.weight| behind1_c))

;@ claim output_play2 abstract: so is the second one's
(same |play2_c'.value| (fp.mul RNE |state'.weight| behind2_c))

;@ claim rate_given free rate by output_rate,rate_range,kept_weight: the rate given is between 0 and the one in range
(ite (fp.geq rate zero) (within |rate_c_per_min'.value| zero rate)
  (within |rate_c_per_min'.value| rate zero))

;@ claim lag_given free lag2 by output_lag,lag2_range,kept_weight: the second lag given is between 0 and the one in range
(ite (fp.geq lag2 zero) (within |lag2_c'.value| zero lag2) (within |lag2_c'.value| lag2 zero))

;@ claim behind1 alone by kept_play1,kept_drag: it is no more than the largest half width, rounded up
(around behind1_c ((_ to_fp 8 24) RNE 1024.0))

;@ claim behind2 alone by kept_play2,kept_drag: so is the second one's
(around behind2_c ((_ to_fp 8 24) RNE 1024.0))

;@ claim play1_given free behind1_c by output_play1,behind1,kept_weight: and no more with the weight
(around |play1_c'.value| ((_ to_fp 8 24) RNE 1024.0))

;@ claim play2_given free behind2_c by output_play2,behind2,kept_weight: so is the second one's
(around |play2_c'.value| ((_ to_fp 8 24) RNE 1024.0))

;@ claim constant free rate,lag2,behind1_c,behind2_c by output_rate,output_lag,output_play1,output_play2,rate_range,lag2_range,behind1,behind2: without weight the constant bias alone is left
(=> (fp.isZero |state'.weight|)
  (and (fp.isZero |rate_c_per_min'.value|) (fp.isZero |lag2_c'.value|)
       (fp.isZero |play1_c'.value|) (fp.isZero |play2_c'.value|)))

;@ claim per_time alone by counters: what is not counted as rejected is, unless there was a loss, within the gate and what the part can have moved since the last accepted one, of that and of the anchor
(=> (and (= |state'.conditioner.rejected| |state.conditioner.rejected|) (not was_lost))
  (and in_range reachable (fp.leq (fp.abs change_c) far_c)))

;@ claim kept_filtered free filtered,rate by filter_equation,kept,shifted,rate_range: the invariant of the filtered temperature is kept
(around |state'.estimator.filtered.value| filter_bound)

;@ claim kept_remainder slow free filtered by filter_equation,kept,shifted: the invariant of its remainder is kept
(around |state'.estimator.filtered.remainder| remainder_bound)

;@ claim kept_lag free alpha2,start2_c by second_equation,kept_second,alpha2,start2: the invariant of the filter of the second lag is kept
(around |state'.second.lag.filtered.value| filter_bound)

;@ claim kept_lag_remainder slow free alpha2 by second_equation,kept_second,alpha2: the invariant of its remainder is kept
(around |state'.second.lag.filtered.remainder| remainder_bound)

;@ claim kept_memory alone by memory_equation: the invariant of the memory is kept
(around |state'.estimator.memory.value| memory_bound)

;@ claim kept_memory_rest slow alone by memory_equation: the invariant of what rounding left out of the memory is kept
(around |state'.estimator.memory.remainder| memory_rest)
