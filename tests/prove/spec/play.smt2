; HistoryState::update for one hysteresis term.
;@ function prove_play

;@ define
(define-fun width_c () F32 |play.plays.half_width_c|)
; That of ThermalState::update.
(define-fun effective_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun contact_bound () F32 ((_ to_fp 8 24) RNE 2098176.0))
(define-fun hot_c () F32 (fp.add RNE |effective_c| width_c))
(define-fun cold_c () F32 (fp.sub RNE |effective_c| width_c))

;@ assume settings: what History::new accepts
(within width_c zero ((_ to_fp 8 24) RNE 1000.0))

;@ assume temperature: what ThermalState::update yields
(within |effective_c| (fp.neg effective_bound) effective_bound)

;@ assume state: the invariant, which HistoryState::new establishes
(within |contact.contacts_c| (fp.neg contact_bound) contact_bound)

;@ claim contact: stays where it is if the lag-compensated temperature is within the half width, else follows at that distance
(= |contact'.contacts_c|
  (ite (fp.lt |contact.contacts_c| cold_c) cold_c
  (ite (fp.gt |contact.contacts_c| hot_c) hot_c |contact.contacts_c|)))

;@ claim distance: given is how far the contact is behind
(= |result| (fp.sub RNE |effective_c| |contact'.contacts_c|))

;@ claim bound: the contact is no further than the half width, rounded
(within |contact'.contacts_c| cold_c hot_c)

;@ claim kept: the invariant is kept, and the distance is finite
(and (finite |result|)
  (within |contact'.contacts_c| (fp.neg contact_bound) contact_bound))
