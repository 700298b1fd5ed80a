; SPDX-License-Identifier: MIT
; A slow piece for the piano, with its pedals. Own music. csound piano.csd writes piano.wav
<CsoundSynthesizer>
<CsOptions>
-W -f -o piano.wav
</CsOptions>
<CsInstruments>
sr = 48000
ksmps = 64
nchnls = 2
0dbfs = 1

gipiano contact_create "piano"

instr Note                 ; key, velocity
  contact_note gipiano, p4, p5
endin

instr Pedal                ; name of the pedal: down as long as the note lasts
  xtratim 0.02
  contact_set gipiano, strget(p4), (release() == 0 ? 1 : 0)
endin

instr Felt                 ; hardness of the hammers, from one value to another
  contact_set gipiano, "stiffness_ratio", expseg(p4, p3, p5)
endin

instr Sound                ; behind those that play
  aleft, aright contact_out gipiano
  outs 4 * aleft, 4 * aright
endin
</CsInstruments>
<CsScore>
t 0 76
i "Sound" 0 21
i "Felt" 0 20 0.5 2
; the pedal changes just after each harmony
i "Pedal" 0.1 3.9 "sustain"
i "Pedal" 4.1 3.9 "sustain"
i "Pedal" 8.1 3.9 "sustain"
i "Pedal" 12.1 3.9 "sustain"
i "Pedal" 16.1 4.4 "sustain"
i "Pedal" 12 8 "una_corda"
; D major with its ninth
i "Note" 0 1 38 0.42
i "Note" 0.5 1 45 0.36
i "Note" 1 1 54 0.38
i "Note" 1.5 1 61 0.4
i "Note" 2 1 64 0.42
i "Note" 2 2 78 0.55
i "Note" 3 0.5 76 0.45
i "Note" 3.5 0.5 73 0.4
; B minor
i "Note" 4 1 35 0.42
i "Note" 4.5 1 47 0.36
i "Note" 5 1 54 0.38
i "Note" 5.5 1 57 0.4
i "Note" 6 1 62 0.42
i "Note" 6 1.5 74 0.55
i "Note" 7.5 0.5 76 0.45
; G major with seventh and ninth
i "Note" 8 1 31 0.46
i "Note" 8.5 1 43 0.4
i "Note" 9 1 50 0.42
i "Note" 9.5 1 54 0.44
i "Note" 10 1 57 0.46
i "Note" 10 1 81 0.62
i "Note" 11 0.5 78 0.52
i "Note" 11.5 0.5 74 0.48
; A with the fourth, then the third; soft from here on
i "Note" 12 1 33 0.38
i "Note" 12.5 1 45 0.32
i "Note" 13 1 52 0.34
i "Note" 13.5 1 55 0.36
i "Note" 14 1 62 0.4
i "Note" 14 1 76 0.46
i "Note" 15 1 61 0.36
i "Note" 15 1 73 0.4
; the chord at the end, from below
i "Note" 16 4 26 0.3
i "Note" 16.06 4 38 0.3
i "Note" 16.12 4 45 0.3
i "Note" 16.18 4 54 0.32
i "Note" 16.24 4 57 0.34
i "Note" 16.3 4 64 0.36
i "Note" 16.36 4 69 0.4
i "Note" 18 2 86 0.24
</CsScore>
</CsoundSynthesizer>
