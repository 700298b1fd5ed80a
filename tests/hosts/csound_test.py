# SPDX-License-Identifier: MIT
"""The opcodes in Csound itself: see host_test.py."""
import os
import random
import struct
import sys
from pathlib import Path

from host_test import (BLOCK, EXAMPLES, HostTest, Instrument, RATE, channels, hz, need, random_lives, require_equal, require_music,
                       require_pitch, run)
from sound import block
import numpy as np

HEADER = f"""<CsoundSynthesizer>
<CsInstruments>
sr = {RATE}
ksmps = {BLOCK}
0dbfs = 1
nchnls = """


def seconds(samples):
    return repr(samples / RATE)


class CsoundTest(HostTest):
    def csound(self, orchestra, score, output, status=0):
        """Renders to double precision; what Csound prints."""
        with open("test.csd", "w") as file:
            file.write(f"{orchestra}\n</CsInstruments>\n<CsScore>\n{score}\n</CsScore>\n</CsoundSynthesizer>\n")
        return run("csound", f"--opcode-lib={self.module}", "-W", "--format=double", "-o", output, "test.csd", status=status)

    def render(self, instrument, taps, performance, samples):
        count = len(taps)
        results = ", ".join(f"a{t}" for t in range(count))
        names = ", ".join(f'"{tap}"' for tap in taps)
        orchestra = f"""{HEADER}{count}
gi contact_create "{instrument.name}"
instr 1
  contact_set gi, strget(p4), p5
endin
instr 2
  contact_note gi, p4, p5
endin
instr 3
  contact_play gi, strget(p4), 1
endin
instr 4
  contact_play gi, strget(p4), 1, p5
endin
instr 10
  {results} contact_out gi, {names}
  outc {results}
endin
"""
        once, score = seconds(BLOCK), [f"i 10 0 {seconds(samples)}"]
        for at, kind, *words in performance:
            if kind == "set":
                score.append(f'i 1 {seconds(at)} {once} "{words[0]}" {words[1]!r}')
            elif kind == "play":
                number, value = (3, "") if words[1] is None else (4, repr(words[1]))
                score.append(f'i {number} {seconds(at)} {once} "{words[0]}" {value}')
            elif words[1] > 0:
                ends = [row[0] for row in performance if row[0] > at and row[1:] == ("note", words[0], 0)]
                score.append(f"i 2 {seconds(at)} {seconds((ends or [samples])[0] - at)} {words[0]} {words[1]!r}")
        self.csound(orchestra, "\n".join(score), "test.wav")
        return np.array(channels("test.wav"))

    def page(self):
        with open("first.csd", "w") as file:
            file.write(block("csound.md", "csound"))
        run("csound", f"--opcode-lib={self.module}", "first.csd")
        require_pitch(channels("first.wav"))

    def pieces(self):
        """The pieces of examples/csound, as the user starts them."""
        folder = os.getcwd()
        os.chdir(EXAMPLES / "csound")
        for name, notes in [("piano", [(1.6, hz(38, 45, 54, 61, 64, 78)), (13.3, hz(38, 45, 54, 57, 64, 69))]),
                            ("drone", [(0.2, hz(43)), (1.4, hz(48)), (3.2, hz(36))]),
                            ("groove", [(9.3, [hz(55)[0], 91])])]:  # second partial of the open G string, heads of the tom
            run("csound", f"--opcode-lib={self.module}", "-o", f"{folder}/{name}.wav", f"{name}.csd")
            require_music(name, channels(f"{folder}/{name}.wav"), notes)

    def hostile(self):
        """A million values at random, at every sample, of each kind of instrument."""
        count = 0
        for name in ("hammer_string", "lap_steel", "snare", "piano", "slap_bass"):
            instrument = Instrument(self.reference, name)
            lines = [f'contact_set gi, "{p}", hostile()' for p in instrument.parameters]
            lines += [f'contact_play gi, "{e}", hostile(), hostile()' for e in instrument.events]
            calls, rounds = len(instrument.parameters) + 2 * len(instrument.events), 20000
            orchestra = HEADER.replace(f"ksmps = {BLOCK}", "ksmps = 1") + f"""1
gi contact_create "{name}"
gkzero init 0
opcode hostile, k, 0
  kdraw = int(random:k(0, 13))
  kvalue = 0
  if kdraw == 0 then
    kvalue = gkzero / gkzero
  elseif kdraw == 1 then
    kvalue = 1 / gkzero
  elseif kdraw == 2 then
    kvalue = -1 / gkzero
  elseif kdraw == 3 then
    kvalue = 1e300
  elseif kdraw == 4 then
    kvalue = -1e300
  elseif kdraw == 5 then
    kvalue = 5e-324
  elseif kdraw < 10 then
    kvalue = random:k(-1, 1)
  elseif kdraw == 10 then
    kvalue = random:k(-1000, 1000)
  endif
  xout kvalue
endop
instr 1
  {chr(10).join(lines)}
  a1 contact_out gi
  out a1
endin
instr 2
  contact_note gi, p4, p5
endin
"""
            draw = random.Random(name)
            score = [f"i 1 0 {seconds(rounds)}"] + [
                f"i 2 {seconds(draw.randrange(rounds))} 0.01 {draw.choice([60, 64, -1e9, 1e30, 127.4])} {draw.choice([0.5, 1e30, -1, 0])}"
                for _ in range(100)]
            self.csound(orchestra, "\n".join(score), "test.wav")
            sound = np.array(channels("test.wav"))
            assert sound.shape[1] >= rounds, sound.shape
            assert np.isfinite(sound).all() and np.abs(sound).max() > 0, name
            count += calls * rounds
        print(count, "values")
        assert count >= 1000000, count

    def velocities(self):
        """A note whose velocity is not a number leaves a key down that another one holds."""
        body = "instr 1\n  contact_note gi, 60, p4 > 0 ? p4 : sqrt(-1)\nendin\ninstr 2\n  a1 contact_out gi\n  out a1\nendin\n"
        score = [(0, 150, 0.7), (20, 40, 0)]
        self.csound(f'{HEADER}1\ngi contact_create "piano"\n{body}', "\n".join(
            [f"i 2 0 {seconds(150 * BLOCK)}"]
            + [f"i 1 {seconds(begin * BLOCK)} {seconds(length * BLOCK)} {velocity}" for begin, length, velocity in score]), "test.wav")
        expected = Instrument(self.reference, "piano").play("double", [(0, "note", 60, 0.7)], 150 * BLOCK)[:1]
        require_equal(expected, channels("test.wav"), "double", "velocities")

    def midi(self):
        """A MIDI file with chords and the pedal, in the orchestra of the page, gives the samples of the class."""
        # A tick is half a block, an odd one the middle of a block: what happens then acts at the beginning of the next.
        tempo, division = 480 * BLOCK // 2 * 10**6 // RATE, 480
        messages, performance = [(1, [0xB0, 64, 0])], []
        for at, chord in [(10, [48, 60, 64]), (60, [47, 62, 67]), (110, [45, 60, 69])]:
            messages += [(2 * at - 1, [0x90, key, 90]) for key in chord] + [(2 * at + 79, [0x80, key, 0]) for key in chord]
            performance += [(at, "note", key, 90 / 127) for key in chord] + [(at + 40, "note", key, 0) for key in chord]
        messages += [(2 * 30 - 1, [0xB0, 64, 127]), (2 * 130 - 1, [0xB0, 64, 0])]
        performance += [(30, "set", "sustain", 1), (130, "set", "sustain", 0)]
        track, now = bytes([0, 0xFF, 0x51, 3]) + tempo.to_bytes(3, "big"), 0
        for at, data in sorted(messages, key=lambda row: row[0]):
            track += bytes([128 | at - now >> 7, at - now & 127, *data])
            now = at
        track += bytes([0, 0xFF, 0x2F, 0])
        Path("song.mid").write_bytes(b"MThd" + struct.pack(">IHHH", 6, 0, 1, division) + b"MTrk" + struct.pack(">I", len(track)) + track)
        Path("midi.csd").write_text(block("csound.md", "csound", 1))
        run("csound", f"--opcode-lib={self.module}", "--format=double", "-F", "song.mid", "midi.csd")
        performance = sorted(((at * BLOCK, *words) for at, *words in performance), key=lambda row: row[0])
        expected = Instrument(self.reference, "piano").play("double", performance, 180 * BLOCK)[:2]
        require_equal(expected, channels("midi.wav"), "double", "song.mid")

    def handles(self):
        """Each opcode plays the instrument that its handle named when the note began."""
        lines, expected = [], []
        for number, name in enumerate(["hammer_string", "tom"], 1):
            instrument = Instrument(self.reference, name)
            parameter, event = next(iter(instrument.parameters)), next(iter(instrument.events))
            value = sum(instrument.parameters[parameter][:2]) / 2
            lines += [f'ih contact_create "{instrument.name}"', f'contact_set ih, "{parameter}", {value!r}',
                      f'contact_play ih, "{event}", kplay', "contact_note ih, 60, 0.7", f'a{number} contact_out ih, "left"']
            performance = [(0, "set", parameter, value), (0, "play", event), (0, "note", 60, 0.7), (75 * BLOCK, "note", 60, 0)]
            expected.append(instrument.play("double", performance, 75 * BLOCK)[0])
        body = "\n  ".join(["kplay init 1", *lines, "kplay = 0", "outs a1, a2"])
        self.csound(f"{HEADER}2\ninstr 1\n  {body}\nendin\n", f"i 1 0 {seconds(75 * BLOCK)}", "test.wav")
        sound = np.array(channels("test.wav"))
        for tap in range(2):
            require_equal(np.array(expected[tap:tap + 1]), sound[tap:tap + 1], "double", f"handle {tap}")

        self.old_handles()

    def old_handles(self):
        """The handle of an instrument whose note has ended is none, also after another instrument was made."""
        orchestra = f"""{HEADER}1
gi init 0
instr 1
  gi contact_create "tom"
endin
instr 2
  ih contact_create "hammer_string"
  contact_note gi, 60, 0.7
  a1 contact_out ih
  out a1
endin
instr 3
  contact_play gi, "strike_stick", 1
endin
instr 4
  ih contact_create "hammer_string"
  a1 contact_out ih
  out a1
endin
"""
        begin, length = seconds(4 * BLOCK), seconds(8 * BLOCK)
        printed = self.csound(orchestra, f"i 1 0 {seconds(BLOCK)}\ni 2 {begin} {length}", "test.wav", 1)
        assert "ihandle: 1 is no instrument" in printed, printed
        # An opcode that began before the instrument ended.
        self.csound(orchestra, f"i 1 0 {seconds(2 * BLOCK)}\ni 3 0 {length}\ni 4 {begin} {length}", "test.wav")
        assert np.abs(channels("test.wav")).max() == 0

    def reinit(self):
        """reinit makes an instrument anew, more often than there are handles; it plays another key."""
        orchestra = f"""{HEADER}1
gi contact_create "piano"
instr 1
  knumber init 0
again:
  contact_note gi, 60 + 4 * i(knumber), 0.7
  a1 contact_out gi
  rireturn
  out a1
  knumber = 1
  kcycle timeinstk
  if kcycle == 75 then
    reinit again
  endif
endin
"""
        self.csound(orchestra, f"i 1 0 {seconds(150 * BLOCK)}", "test.wav")
        performance = [(0, "note", 60, 0.7), (75 * BLOCK, "note", 60, 0), (75 * BLOCK, "note", 64, 0.7)]
        expected = Instrument(self.reference, "piano").play("double", performance, 150 * BLOCK)[:1]
        require_equal(expected, channels("test.wav"), "double", "keys")
        rounds, blocks = 1100, 4
        orchestra = f"""{HEADER}1
instr 1
again:
  ih contact_create "hammer_string"
  contact_note ih, 60, 0.7
  a1 contact_out ih
  rireturn
  out a1
  kcycle timeinstk
  if kcycle % {blocks} == 0 then
    reinit again
  endif
endin
"""
        self.csound(orchestra, f"i 1 0 {seconds(rounds * blocks * BLOCK)}", "test.wav")
        one = Instrument(self.reference, "hammer_string").play("double", [(0, "note", 60, 0.7)], blocks * BLOCK)[:1]
        require_equal(np.tile(one, rounds), channels("test.wav"), "double", "reinit")

    def lifetimes(self):
        """100 instruments begin and end at random, more than one at a time."""
        orchestra = HEADER + """1
instr 1
  Sname strget p4
  i1 contact_create Sname
  contact_note i1, 60, 0.7
  a1 contact_out i1
  out a1
endin
"""
        score = [f'i 1 {seconds(begin * BLOCK)} {seconds((end - begin) * BLOCK)} "{name}"' for begin, end, name in random_lives(1)]
        printed = self.csound(orchestra, "\n".join(score), "test.wav")
        sound = np.array(channels("test.wav"))
        assert np.isfinite(sound).all() and np.abs(sound).max() > 0.01 and "ERROR" not in printed

    def refusals(self):
        """What is wrong is said in a line, and no sound is made."""
        for line, said in [
            ('i1 contact_create "harpsichord"', "harpsichord: INSTRUMENT: no such instrument ships; allowed: a .json file"),
            ('i1 contact_create "absent.json"', "absent.json: file: does not exist"),
            ('contact_set 7, "strike_m", 1', "ihandle: 7 is no instrument"),
            ('contact_set gi, "strike", 1', "Sparameter: there is none of the name strike; allowed are:"),
            ('contact_play gi, "strike_m", 1', "Sevent: there is none of the name strike_m; allowed are:"),
            ('a1 contact_out gi, "sound"', "Soutput: there is none of the name sound; allowed are:"),
            ('a1, a2 contact_out gi, "left"', "2 results for 1 names"),
            ('a1 contact_out gi\n a2 contact_out gi', "plays this instrument already"),
        ]:
            printed = self.csound(f'{HEADER}1\ngi contact_create "hammer_string"\ninstr 1\n {line}\nendin\n', "i 1 0 0.1", "test.wav", 1)
            if said not in printed or "INIT ERROR" not in printed:
                sys.exit(f"{line}: not said: {said}\n{printed}")


need("csound")
CsoundTest().main()
