; SPDX-License-Identifier: MIT
; A slapped bass, a snare and a tom. Own music. csound groove.csd writes groove.wav
<CsoundSynthesizer>
<CsOptions>
-W -f -o groove.wav
</CsOptions>
<CsInstruments>
sr = 48000
ksmps = 64
nchnls = 2
0dbfs = 1

gibass contact_create "slap_bass"
gisnare contact_create "snare"
gitom contact_create "tom"

instr Thumb                ; speed [m/s]
  contact_play gibass, "strike_thumb", (timeinstk() == 1 ? 1 : 0), p4
endin

instr Pop                  ; force [N], away from the frets
  contact_play gibass, "pluck_pop", (timeinstk() == 1 ? 1 : 0), p4
endin

instr Press                ; the fret behind which a finger presses: 2, 5, 7 or 9
  contact_set gibass, sprintf("press_%d_force_n", p4), linsegr(0, 0.02, 9, 1, 9, 0.03, 0)
endin

instr Palm                 ; mutes the bass
  contact_set gibass, "palm_damping_per_s", linsegr(0, 0.02, 40, 1, 40, 0.02, 0)
endin

instr Snare                ; speed [m/s]
  contact_play gisnare, "strike_stick", (timeinstk() == 1 ? 1 : 0), p4
endin

instr Strainer             ; moves the wires away from the head [m]
  contact_set gisnare, "strainer_gap_shift_m", p4
endin

instr Tom                  ; speed [m/s]
  contact_play gitom, "strike_stick", (timeinstk() == 1 ? 1 : 0), p4
endin

instr Sound
  abass contact_out gibass
  asnare contact_out gisnare
  atom contact_out gitom
  adrums = 0.35 * asnare + 0.4 * atom
  aleft, aright reverbsc 0.4 * adrums, 0.4 * adrums, 0.6, 7000
  outs 0.55 * abass + 0.9 * adrums + 0.3 * aleft, 0.55 * abass + 0.8 * adrums + 0.3 * aright
endin
</CsInstruments>
<CsScore>
t 0 104
i "Sound" 0 18
{ 4 BAR
; G, the octave of the line on fret 5 and 7, and a pop at the end of each bar
i "Thumb" [4 * $BAR] 0.1 3.2
i "Thumb" [4 * $BAR + 0.75] 0.1 2.4
i "Press" [4 * $BAR + 1.35] 0.6 5
i "Thumb" [4 * $BAR + 1.5] 0.1 3
i "Press" [4 * $BAR + 2.1] 0.3 7
i "Thumb" [4 * $BAR + 2.25] 0.1 3.2
i "Palm" [4 * $BAR + 2.7] 0.2
i "Thumb" [4 * $BAR + 3] 0.1 3
i "Press" [4 * $BAR + 3.35] 0.4 2
i "Pop" [4 * $BAR + 3.5] 0.1 -9
i "Snare" [4 * $BAR + 1] 0.1 4
i "Snare" [4 * $BAR + 2.75] 0.1 1
i "Snare" [4 * $BAR + 3] 0.1 4.5
i "Tom" [4 * $BAR] 0.1 5
i "Tom" [4 * $BAR + 2.5] 0.1 4
}
; without wires, as a second tom
i "Strainer" 14.4 0.1 0.002
i "Tom" 15 0.1 5
i "Tom" 15.25 0.1 4
i "Snare" 15.5 0.1 4
i "Strainer" 15.9 0.1 0
i "Thumb" 16 0.1 4
i "Tom" 16 0.1 6
</CsScore>
</CsoundSynthesizer>
