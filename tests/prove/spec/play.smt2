; Play::follow.
;@ function prove_play

;@ define
(define-fun width_c () F32 |half_width_c|)
; Of the temperature that drags the play.
(define-fun drag_bound () F32 ((_ to_fp 8 24) RNE 2097152.0))
(define-fun contact_bound () F32 ((_ to_fp 8 24) RNE 2098176.0))
(define-fun hot_c () F32 (fp.add RNE |drag_c| width_c))
(define-fun cold_c () F32 (fp.sub RNE |drag_c| width_c))

;@ assume settings: what Thermal::new accepts
(within width_c zero ((_ to_fp 8 24) RNE 1000.0))

;@ assume temperature: what PlayState::update makes
(within |drag_c| (fp.neg drag_bound) drag_bound)

;@ assume state: the invariant, which Play::new establishes
(within |play.contact_c| (fp.neg contact_bound) contact_bound)

;@ claim contact: stays where it is if the temperature that drags it is within the half width, else follows at that distance
(= |play'.contact_c|
  (ite (fp.lt |play.contact_c| cold_c) cold_c
  (ite (fp.gt |play.contact_c| hot_c) hot_c |play.contact_c|)))

;@ claim distance: given is how far the contact is behind
(= |result| (fp.sub RNE |drag_c| |play'.contact_c|))

;@ claim bound: the contact is no further than the half width, rounded
(within |play'.contact_c| cold_c hot_c)

;@ claim kept: the invariant is kept, and the distance is finite
(and (finite |result|)
  (within |play'.contact_c| (fp.neg contact_bound) contact_bound))
