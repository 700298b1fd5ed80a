; SPDX-License-Identifier: MIT
; A drone on four strings of examples/instruments/drone.json. The bridge comes closer to the strings and goes away, which moves the
; band of high partials. Start it in this folder: csound drone.csd writes drone.wav
<CsoundSynthesizer>
<CsOptions>
-W -f -o drone.wav
</CsOptions>
<CsInstruments>
sr = 48000
ksmps = 64
nchnls = 2
0dbfs = 1

gidrone contact_create "../instruments/drone.json"

instr Pluck                ; key, velocity
  contact_note gidrone, p4, p5
endin

instr Bridge               ; depth [m], frequency [Hz]
  contact_set gidrone, "bridge_gap_shift_m", lfo(p4, p5)
endin

instr Hand                 ; damps all strings at the end
  contact_set gidrone, "hand_damping_per_s", linseg(0, p3, 12)
endin

instr Sound                ; the strings hang to the left, their echoes to the right
  awire contact_out gidrone
  aleft, aright reverbsc awire, awire, 0.8, 9000
  outs 0.6 * awire + 0.12 * aleft, 0.5 * awire + 0.16 * aright
endin
</CsInstruments>
<CsScore>
i "Sound" 0 16
i "Bridge" 4 9 6e-6 0.25
; fifth, twice the tonic, its octave below
{ 3 ROUND
i "Pluck" [4.4 * $ROUND] 4 43 0.9
i "Pluck" [4.4 * $ROUND + 1.1] 4 48 1
i "Pluck" [4.4 * $ROUND + 2.0] 4 48 0.8
i "Pluck" [4.4 * $ROUND + 2.9] 4 36 0.75
}
i "Hand" 14.5 1.5
</CsScore>
</CsoundSynthesizer>
