# SPDX-License-Identifier: MIT
import concurrent.futures
import copy
import json
import math
import os
import pathlib
import pickle
import subprocess
import sys
import wave

import numpy as np
import pytest

import contactspline as cs

HAMMER = {"resonator": "string_c4", "material": "felt_c4"}
KEYBOARDS = pathlib.Path(__file__).parents[3] / "data/keyboards"
OWN = {"name": "own", "description": "five keys", "keyboard": {
    "first_key": 58, "last_key": 62, "first_double_key": 60, "first_triple_key": 61, "last_damped_key": 61,
    "concert_pitch_hz": 480, "min_speed_m_per_s": 0.2, "max_speed_m_per_s": 5, "felt_loss_s_per_m": 0.2,
    "damper_per_s": 60, "damper_time_s": 0.005, "segments": 16,
    "body": {"resonator": "soundboard", "double_hz": [-0.05, 0.05], "triple_hz": [-0.06, 0.015, 0.08],
             "una_corda_stiffness_ratio": 0.5},
    "notes": [{"key": key, "length_m": length, "mass_kg": mass, "bending_stiffness_n_m2": 0.01, "strike_position_m": 0.1,
               "constant_loss_per_s": 0.4, "quadratic_loss_m2_per_s": 8e-5, "hammer_mass_kg": 0.009,
               "stiffness_n_per_m_alpha": 2e9, "exponent": 2.4}
              for key, length, mass in [(48, 1.26, 0.0088), (72, 0.34, 0.0018)]]}}


def made(name):
    parts = {"hammer_string": HAMMER, "mass_barrier": {"material": "felt_c4"}}
    return cs.Instrument("piano", keyboard=OWN) if name == "own keyboard" else cs.Instrument(name, **parts.get(name, {}))


def blow(instrument, time=0.01):
    event = next(iter(instrument.events.values()), None)
    if event is None:
        return cs.note(time, 60, 0.7)
    play = getattr(cs, event["kind"])
    return play(time, instrument.parameters[event["parameter"]]["initial"], event["number"])


ALL = ["hammer_string", "mass_barrier", "piano", "own keyboard", *cs.shipped("instruments")]


@pytest.mark.parametrize("name", ALL)
def test_every_instrument_sounds_in_both_precisions_and_again_alike(name):
    instrument = made(name)
    seconds = 0.03 if name == "piano" else 0.1
    sound = instrument.play(blow(instrument), seconds)
    again = instrument.play(blow(instrument), seconds)
    single = instrument.play(blow(instrument), seconds, precision="single")
    assert list(sound.outputs) == list(instrument.outputs)
    assert any(np.any(samples != 0) for samples in sound.outputs.values())
    for output, samples in sound.outputs.items():
        assert samples.dtype == np.float64 and single[output].dtype == np.float32
        assert len(samples) == round(seconds * 44100) and np.all(np.isfinite(samples))
        assert np.array_equal(samples, again[output])
    assert all(row["min"] <= row["initial"] <= row["max"] for row in instrument.parameters.values())


@pytest.mark.parametrize("name", ALL)
def test_what_was_played_before_changes_nothing(name):
    seconds = 0.02
    used, fresh = made(name), made(name)
    changes = [cs.change(0.003, parameter, 0.3 * row["min"] + 0.7 * row["max"]) for parameter, row in used.parameters.items()]
    used.play([blow(used, 0.001), *changes, cs.note(0.008, 67, 0.9)], seconds)
    used.play(blow(used), seconds, sample_rate_hz=48000)
    used.play([blow(used, 0.001), *changes], seconds, parameters={parameter: row["max"] for parameter, row in used.parameters.items()})
    again, first = (instrument.play(blow(instrument, 0.001), seconds, energy_step=10) for instrument in (used, fresh))
    for output in first.outputs:
        assert np.array_equal(again[output], first[output])
    assert np.array_equal(again.force_n, first.force_n) and np.array_equal(again.energy_j, first.energy_j)
    assert np.any(first.samples != 0)


# The emitted header and the keyboard's file are two ways to the same strings and hammers; their numbers are rounded once.
@pytest.mark.parametrize("keyboard", ["piano", KEYBOARDS / "piano.json"], ids=str)
def test_the_keyboard_that_ships_is_that_of_the_piano(keyboard):
    events = [cs.note(0, 60, 0.7, 0.1), cs.note(0.05, 30, 1), cs.note(0.1, 100, 0.3)]
    wanted, own = (piano.play(events, 0.2) for piano in (cs.Instrument("piano"), cs.Instrument("piano", keyboard=keyboard)))
    for name, samples in wanted.outputs.items():
        assert np.max(np.abs(samples)) > 0.001
        assert np.max(np.abs(own[name] - samples)) < 1e-9 * np.max(np.abs(samples))
    assert np.max(np.abs(own.force_n - wanted.force_n)) < 1e-9 * np.max(wanted.force_n)


def test_a_keyboard_of_ones_own_has_its_pitch_and_its_speeds(tmp_path):
    piano, keys = cs.Instrument("piano", keyboard=OWN), cs.Keyboard(OWN).keys
    assert (piano.name, piano.description, piano.parameters["loss_s_per_m"]["initial"]) == ("own", "five keys", 0.2)
    assert keys[60]["pitch_hz"] == pytest.approx(480 * 2 ** (-9 / 12))
    sound = piano.play(cs.note(0, 60, 0.8), 2)
    spectrum = np.abs(np.fft.rfft(sound.samples * np.hanning(len(sound.samples))))
    near = slice(round(2 * keys[60]["pitch_hz"]) - 40, round(2 * keys[60]["pitch_hz"]) + 41)  # bins of 0.5 Hz
    assert abs((near.start + np.argmax(spectrum[near])) / 2 - keys[60]["pitch_hz"]) < 1  # two strings, and a bin
    assert np.array_equal(piano.play(cs.note(0, 63, 1), 0.05).samples, np.zeros(2205))  # has no such key
    (tmp_path / "own.json").write_text(json.dumps(OWN))
    for velocity in (0, 0.3, 1):  # the same blow by a score, which tells its speed and keeps forces in single precision
        blow = {"time_s": 0, "key": 60, "hold_s": 0.05, "speed_m_per_s": 0.2 * (5 / 0.2)**velocity}
        (tmp_path / "blow.json").write_text(json.dumps({"instrument": "own.json", "description": "a blow",
                                                        "duration_s": 0.1, "events": [blow]}))
        wanted = cs.play_score(tmp_path / "blow.json").force_n.max()
        assert wanted > 0.1 and piano.play(cs.note(0, 60, velocity), 0.1).force_n.max() == pytest.approx(wanted, rel=1e-6)


def test_a_bow_is_lifted_after_its_hold():
    violin = cs.Instrument("violin")
    bowed = violin.play(cs.bow(0, 5, "bow_on_d", hold_s=0.2), 0.6)
    assert np.array_equal(bowed.samples, violin.play(cs.note(0, 62, 1, hold_s=0.2), 0.6).samples)
    held = violin.play(cs.bow(0, event=1), 0.6)
    assert np.array_equal(held.samples[:8820], bowed.samples[:8820])
    assert np.abs(held.samples[-4410:]).max() > 10 * np.abs(bowed.samples[-4410:]).max() > 0


def test_a_bow_may_jump_at_each_sample():
    """Force, speed and place for three seconds; then the bow is lifted, and the strings ring out."""
    violin, random = cs.Instrument("violin"), np.random.default_rng(1)
    samples, played = 4 * 44100, 3 * 44100
    moves = {}
    for name in ("bow_normal_force_n", "bow_surface_speed_m_per_s", "bow_place_m"):
        row = violin.parameters[name]
        moves[name] = np.where(random.random(samples) < 0.25, row["max"], random.uniform(row["min"], row["max"], samples))
    keys = [cs.note(at, int(random.integers(55, 92)), hold_s=0.05) for at in np.arange(60) * 0.05]
    for precision in ("double", "single"):
        sound = violin.play(keys, samples / 44100, parameters=moves, precision=precision)
        for output in sound.outputs.values():
            assert np.isfinite(output).all()
        force_n = np.abs(sound.outputs["bridge_force_n"])
        assert 0.1 < force_n.max() < 100
        assert force_n[-2205:].max() < force_n[:played].max() / 10


@pytest.mark.parametrize("wrong, line", [
    ({"keyboard": 3}, "piano: keyboard: is not a string; allowed: a .json file, piano"),
    ({"keyboard": "pianoo"}, "piano: keyboard: 'pianoo' does not ship; allowed: a .json file, piano"),
    ({"keyboard": "felt_c4"}, "piano: keyboard: 'felt_c4' is a material; allowed: a .json file, piano"),
    ({"keyboard": {"name": "own"}}, "piano: keyboard: keyboard: missing; allowed: first_key"),
    ({"keyboard": {**OWN, "keyboard": {key: value for key, value in OWN["keyboard"].items() if key != "body"}}},
     "piano: keyboard: keyboard.body: missing; allowed: one such as"),
    ({"keyboard": cs.Keyboard(OWN)}, "Keyboard: is no value of a file; allowed: a name, a path, a number, a list or a dict"),
    ({"keyboard": b"piano"}, "bytes: is no value of a file; allowed: a name"),
    ({"keyboard": OWN, "felt": 1}, "piano: felt: unknown key; allowed: keyboard"),
    ({"keyboard": pathlib.Path("no") / "such.json"}, "piano: keyboard: no/such.json: file: does not exist")])
def test_other_keyboards_are_refused_in_one_line(wrong, line):
    with pytest.raises(cs.Error) as raised:
        cs.Instrument("piano", **wrong)
    assert str(raised.value).startswith(line) and "\n" not in str(raised.value)


@pytest.mark.parametrize("wrong, line", [
    ({"felt": "felt_c4"}, "mass_barrier: felt: unknown key; allowed: material"),
    ({"material": "felt_c44"}, "mass_barrier: material: 'felt_c44' does not ship; allowed: a .json file, felt_c4"),
    ({"material": {"name": "own"}}, "mass_barrier: material: contact: missing; allowed: stiffness_n_per_m_alpha")])
def test_other_materials_are_refused_in_one_line(wrong, line):
    with pytest.raises(cs.Error) as raised:
        cs.Instrument("mass_barrier", **wrong)
    assert str(raised.value).startswith(line) and "\n" not in str(raised.value)


def test_numbers_arrays_and_paths_are_those_of_a_file(tmp_path):
    notes = np.array([dict(note, key=np.int64(note["key"])) for note in OWN["keyboard"]["notes"]])
    keyboard = {**OWN["keyboard"], "first_key": np.int32(58), "concert_pitch_hz": np.float32(480), "notes": notes}
    (tmp_path / "own.json").write_text(json.dumps(OWN))
    sounds = [cs.Instrument("piano", keyboard=own).play(cs.note(0, 60, 1), 0.05).samples
              for own in (OWN, {**OWN, "keyboard": keyboard}, tmp_path / "own.json")]
    assert np.any(sounds[0] != 0) and np.array_equal(sounds[0], sounds[1]) and np.array_equal(sounds[0], sounds[2])


def test_threads_share_an_instrument():
    instrument = made("hammer_string")
    speeds = np.linspace(0.5, 4, 40)

    def play(speed):
        return instrument.play(cs.strike(0, speed), 0.05)["bridge_force_n"]

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        together = list(pool.map(play, speeds))
    assert all(np.array_equal(sound, play(speed)) for sound, speed in zip(together, speeds))


def test_a_hammer_string_plays_what_an_instrument_file_plays():
    example = cs.Instrument(KEYBOARDS.parents[1] / "examples/instruments/hammer_on_string.json")
    expected = example.play(cs.strike(0.01, 2.5), 0.5, outputs="bridge_end_force_n").samples
    sound = made("hammer_string").play(cs.strike(0.01, 2.5), 0.5, outputs="bridge_force_n").samples
    assert np.max(np.abs(sound)) > 1 and np.allclose(sound, expected, rtol=0, atol=1e-8 * np.max(np.abs(sound)))


# One key of the piano, a quarter of a second long: it rings on behind the file.
SONG = b"MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0\x0c\0\x90\x60\x60\x30\x80\x60\0\0\xff\x2f\0"


@pytest.mark.parametrize("score", ["trichord_blows", "buzz_line", "tanpura_drone", "slap_line", "song.mid"])
def test_scores_are_those_of_the_program(tmp_path, program, score):
    if score == "song.mid":
        score = str(tmp_path / score)
        (tmp_path / "song.mid").write_bytes(SONG)
    samples = np.asarray(cs.play_score(score).samples, float).reshape(-1)
    gain = math.floor(-20 * math.log10(np.max(np.abs(samples))) - 1)
    path = tmp_path / "sound.wav"
    assert program("render", score, "--no-figure", "--gain", gain, "-o", path).returncode == 0
    with wave.open(str(path)) as file:
        assert file.getsampwidth() == 3
        frames = np.frombuffer(file.readframes(file.getnframes()), np.uint8).reshape(-1, 3).astype(np.int32)
        channels = file.getnchannels()
    whole = (frames[:, 0] | frames[:, 1] << 8 | frames[:, 2] << 16) << 8 >> 8
    assert len(samples) == len(whole) and np.max(np.abs(whole)) > 2**20
    unfaded = len(samples) - round(0.01 * 44100) * channels
    lost = samples[:unfaded] * 10 ** (gain / 20) * 2**23 - whole[:unfaded]
    # libsndfile rounds to 32 bits, which is 2**-9 of the file's step, and cuts off what is below 24.
    assert -0.002 < np.min(lost) and np.max(lost) < 1


def test_a_midi_file_is_played_by_instruments_of_its_channels(tmp_path):
    song, drums = tmp_path / "song.mid", tmp_path / "drums.mid"
    drums.write_bytes(SONG.replace(b"\0\x90\x60", b"\0\x99\x26").replace(b"\x30\x80\x60", b"\x30\x89\x26"))
    two = bytearray(SONG.replace(b"\0\0\0\x0c\0\x90", b"\0\0\0\x14\0\x99\x26\x60\0\x90"))
    song.write_bytes(two.replace(b"\x60\0\0\xff", b"\x60\0\0\x89\x26\0\0\xff"))
    mix = cs.play_score(song, instrument={1: "piano", "10": "kit"})
    piano, kit = cs.play_score(song), cs.play_score(song, instrument="kit", channel=10)
    expected = np.zeros(mix.samples.shape)
    expected[:len(piano.samples)] += piano.samples * 12
    expected[:len(kit.samples)] += kit.samples[:, None] / 2
    assert np.allclose(mix.samples, expected, rtol=0, atol=1e-6 * np.max(np.abs(expected)))
    assert mix.contacts == piano.contacts + kit.contacts
    assert np.array_equal(cs.play_score(drums, instrument="kit").samples, cs.play_score(drums, instrument="kit", channel=[10]).samples)
    one = cs.play_score(song, instrument="kit", channel=np.int64(10))
    assert np.array_equal(one.samples, kit.samples)
    for wrong, arguments in {"which is for drums; allowed: channel 10 to play": {}, "instrument: '17=kit' names no channel": {
            "instrument": {17: "kit"}}, "channel: 17 is refused; allowed: an integer from 1": {"channel": 17},
            "channel: 'x' is refused": {"channel": "x"}, "'01' has two instruments": {"instrument": {1: "kit", "01": "piano"}}}.items():
        with pytest.raises(cs.Error, match=wrong):
            cs.play_score(drums, **arguments)
    with pytest.raises(cs.Error, match="are for MIDI files"):
        cs.play_score({"instrument": "kit"}, instrument="kit")


def test_parts_are_mixed_by_the_controllers_of_their_channels(tmp_path):
    song, plain = tmp_path / "song.mid", tmp_path / "plain.mid"
    note = b"\0\x90\x3c\x60" b"\x30\x80\x3c\0" b"\0\xff\x2f\0"
    for path, before in ((plain, b""), (song, b"\0\xb0\x07\x50" b"\0\xb0\x0a\0")):  # volume 80, pan hard left
        path.write_bytes(SONG[:14] + b"MTrk" + (len(before) + len(note)).to_bytes(4, "big") + before + note)
    alone = cs.play_score(plain, instrument={1: "trichord_c4"}).samples
    mixed = cs.play_score(song, instrument={1: "trichord_c4"}).samples
    assert alone.shape == (len(mixed),) and mixed.shape[1:] == (2,) and not mixed[:, 1].any()
    assert np.allclose(mixed[:, 0], math.sqrt(2) * 0.8**2 * alone, rtol=0, atol=1e-6 * np.max(np.abs(alone)))


def test_a_path_is_a_name_and_stands_in_messages_as_it_is(tmp_path, program):
    folder = tmp_path / "a,b--channel"
    folder.mkdir()
    song, guitar = folder / "song.mid", folder / "my=guitar.json"
    song.write_bytes(SONG.replace(b"\x90\x60", b"\x90\x3c").replace(b"\x80\x60", b"\x80\x3c"))  # key 60
    guitar.write_text(program("show", "classical_guitar", "--name", "my_guitar").stdout)
    played = cs.play_score(song, instrument=guitar)
    assert np.array_equal(cs.play_score(song, instrument={1: guitar}).samples, played.samples)
    with pytest.raises(cs.Error, match=r"a,b--channel/song\.mid: MIDI: no note is on channel 2; allowed: channel 1"):
        cs.play_score(song, channel=2)


def test_keys_are_tuned_by_files_of_scala(tmp_path):
    # Middle C four keys higher: the key plays the strings of middle C. Its neighbour is left out.
    (tmp_path / "up.kbm").write_text("2\n0\n127\n64\n64\n261.6255653005986\n12\n0\nx\n")
    (tmp_path / "bad.scl").write_text("a scale\n1\n2/0\n")
    cents = cs.read_tuning(keymap=tmp_path / "up.kbm")
    assert len(cents) == 128 and abs(cents[64] + 400) < 1e-9 and math.isnan(cents[65])
    assert np.allclose(cs.read_tuning(a4_hz=442), 1200 * math.log2(442 / 440), atol=1e-9)
    guitar = cs.Instrument("fret_guitar")
    tuned = guitar.play(cs.note(0, 64, 0.7), 0.2, tuning=cents)
    plain = guitar.play(cs.note(0, 60, 0.7), 0.2)
    for name in guitar.outputs:
        assert np.allclose(tuned[name], plain[name], rtol=0, atol=1e-6 * np.max(np.abs(plain[name])))
    assert not np.any(guitar.play(cs.note(0, 65, 0.7), 0.1, tuning=cents)[next(iter(guitar.outputs))])
    score = {"instrument": "piano", "duration_s": 0.2,
             "events": [{"time_s": 0, "key": 60, "speed_m_per_s": 2}]}
    high = {**score, "events": [{"time_s": 0, "key": 64, "speed_m_per_s": 2}]}
    expected = cs.play_score(score).samples
    for sound in (cs.play_score(high, keymap=tmp_path / "up.kbm"), cs.play_score({**high, "keymap": str(tmp_path / "up.kbm")})):
        assert np.allclose(sound.samples, expected, rtol=0, atol=1e-5 * np.max(np.abs(expected)))
    with pytest.raises(cs.Error, match="bad.scl: line 3: the ratio 2/0 is not positive; allowed"):
        cs.read_tuning(tmp_path / "bad.scl")
    with pytest.raises(cs.Error, match="snare: tuning: it has no keys"):
        cs.Instrument("snare").play(cs.note(0, 38), 0.1, tuning=cents)
    with pytest.raises(cs.Error, match="tuning: has 12 numbers; allowed: 128"):
        guitar.play(cs.note(0, 60), 0.1, tuning=cents[:12])


def test_a_finer_run_follows_a_blow_of_steel():
    steel = cs.Instrument("mass_barrier", material="steel_on_steel")
    exact = cs.Material("steel_on_steel").impact(2)
    coarse, fine = (steel.play(cs.strike(0, 2), 0.01, oversample=factor, energy_step=100) for factor in (1, 8))
    assert len(fine.force_n) == len(coarse.force_n) == 441 and len(fine.energy_j) == 4
    assert np.max(coarse.force_n) < 0.7 * exact.max_force_n
    # The force of a sample is its mean, and the peak may lie between two of the 10.6 samples: 1 - cos(pi/2/10.6) and a fifth
    # of that for the mean, where the blow is half a period of a sine. Hertz' pulse is sharper.
    assert abs(np.max(fine.force_n) / exact.max_force_n - 1) < 0.03
    assert abs(np.argmax(fine.force_n) - np.argmax(coarse.force_n)) <= 1
    for factor in (0, 3, 8.5):
        with pytest.raises(cs.Error, match="oversample: .* is refused; allowed: 1, 2, 4, 8"):
            steel.play(cs.strike(0), 0.01, oversample=factor)


def test_energy_falls_after_a_blow():
    sound = made("hammer_string").play(cs.strike(0, 2.5), 0.5, energy_step=441)
    assert len(sound.energy_j) == 50 and np.all(sound.energy_j > 0)
    assert np.all(np.diff(sound.energy_j[5:]) <= 0)  # the hammer has left after 50 ms
    assert sound.energy_j[5] < 0.5 * 2.97e-3 * 2.5**2
    assert sound.force_n.max() > 10 and sound.force_n.min() >= 0


def test_parameters_move_over_time():
    instrument = made("hammer_string")
    still = instrument.play(cs.strike(0, 2), 0.3)
    damped = instrument.play(cs.strike(0, 2), 0.3, parameters={"damping_per_s": np.repeat([0.0, 100.0], 50)})
    half = len(still.samples) // 2
    for output in still.outputs:
        assert np.array_equal(still[output][:half], damped[output][:half])
    width = 100 * 1000 / 44100  # of the last stretch, in time constants
    decay = math.exp(-100 * 0.15 + width / 2) * math.sqrt(math.sinh(width) / width)
    rms = np.sqrt(np.mean(damped["bridge_force_n"][-1000:] ** 2) / np.mean(still["bridge_force_n"][-1000:] ** 2))
    assert rms == pytest.approx(decay, rel=0.1)
    changed = instrument.play([cs.strike(0, 2), cs.change(0.15, "damping_per_s", 100)], 0.3)
    assert np.array_equal(changed["bridge_force_n"], damped["bridge_force_n"])


def test_many_are_the_same_in_any_order_batch_and_number_of_threads():
    instrument = made("hammer_string")
    speeds = np.linspace(0.5, 4, 9)
    masses = np.geomspace(0.001, 0.01, 9)
    columns = {"hammer_mass_kg": masses, "stiffness_ratio": speeds}
    played = cs.render_many(instrument, columns, cs.strike(0, 2), 0.1, output="bridge_force_n", threads=1)
    assert played.dtype == np.float32 and played.shape == (9, 4410) and np.all(np.any(played != 0, axis=1))
    for threads in (2, 5):
        assert np.array_equal(
            cs.render_many(instrument, columns, cs.strike(0, 2), 0.1, output="bridge_force_n", threads=threads), played)
    backwards = {name: values[::-1] for name, values in columns.items()}
    assert np.array_equal(
        cs.render_many(instrument, backwards, cs.strike(0, 2), 0.1, output="bridge_force_n")[::-1], played)
    for i in (0, 4, 8):
        alone = instrument.play(cs.strike(0, 2), 0.1, precision="single", outputs="bridge_force_n", force=False,
                                parameters={name: values[i] for name, values in columns.items()})
        assert np.array_equal(alone["bridge_force_n"], played[i])
    into = np.zeros((9, 4410), np.float32)
    cs.render_many(instrument, columns, cs.strike(0, 2), 0.1, output="bridge_force_n", out=into)
    assert np.array_equal(into, played)


def test_a_blow_without_a_speed_has_that_of_its_parameter():
    string = made("hammer_string")
    speeds = np.array([0.5, 2.0, 5.0])
    rows = cs.render_many(string, {"speed_m_per_s": speeds}, cs.strike(0), 0.1, output="bridge_force_n")
    for row, speed in zip(rows, speeds):
        one = string.play(cs.strike(0, speed), 0.1, precision="single", outputs="bridge_force_n")["bridge_force_n"]
        assert np.array_equal(row, one)
        two = string.play([cs.change(0, "speed_m_per_s", speed), cs.strike(0)], 0.1, precision="single", outputs="bridge_force_n")
        assert np.array_equal(two["bridge_force_n"], one)
    plucked = cs.Instrument("tanpura")
    (event,) = (row for row in plucked.events.values() if row["number"] == 0)
    force = plucked.parameters[event["parameter"]]["initial"]
    assert np.array_equal(plucked.play(cs.pluck(0), 0.1).samples, plucked.play(cs.pluck(0, force), 0.1).samples)


@pytest.mark.parametrize("wrong, told", [
    (dict(parameters={"hammer_mass_kg": [0.003, -1]}), "hammer_mass_kg: -1.0 is refused"),
    (dict(parameters={"hammer_mass_kg": [0.003, math.nan]}), "hammer_mass_kg: nan is refused"),
    (dict(parameters={"speed_m_per_s": [1, 2]}), "changes nothing"), (dict(parameters=[1, 2]), "no dict"),
    (dict(parameters={"hammer_mass_kg": [0.003, 0.004], "loss_s_per_m": [0.1]}), r"loss_s_per_m has the shape \(1,\)"),
    (dict(threads=0), "threads"), (dict(threads=10**9), "1 to 1024"), (dict(out=[1]), "out: is no array"),
    (dict(out=np.broadcast_to(np.zeros(4410, np.float32), (2, 4410))), "out: is no array")])
def test_what_is_wrong_in_a_batch_is_told(wrong, told):
    with pytest.raises(cs.Error, match=told) as raised:
        cs.render_many(made("hammer_string"), **{"parameters": {"hammer_mass_kg": [0.003, 0.004]}, "events": cs.strike(0, 2),
                                                 "seconds": 0.1, **wrong})
    assert "\n" not in str(raised.value)


def test_progress_reaches_the_end_and_more_threads_than_rows_are_no_error():
    told = []
    cs.render_many(made("hammer_string"), {"hammer_mass_kg": [0.003, 0.004]}, cs.strike(0, 2), 0.1, threads=1000,
                   progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (2, 2)


def test_a_batch_uses_the_cores_that_the_process_may_use():
    code = "import os; os.sched_setaffinity(0, {0}); from contactspline.source import threads_of; print(threads_of(None))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "1"


def test_instruments_and_materials_are_pickled_and_copied():
    for one in (made("hammer_string"), cs.Instrument("tanpura"), cs.Instrument("mass_barrier", material="felt_c4")):
        again = pickle.loads(pickle.dumps(one))
        blow = cs.pluck(0) if "tanpura" in one.name else cs.strike(0)
        assert np.array_equal(again.play(blow, 0.05).samples, one.play(blow, 0.05).samples)
        assert copy.deepcopy(one).parameters == one.parameters
    for felt in (cs.Material("felt_c4"), *cs.design_many(["felt_c2"])):
        assert np.array_equal(pickle.loads(pickle.dumps(felt)).knots_m, felt.knots_m)
    struck = cs.StruckString()
    assert np.array_equal(copy.deepcopy(struck).play(0.01)[1], struck.play(0.01)[1])


def test_first_values_are_those_of_the_parts():
    string = cs.Instrument("hammer_string", **HAMMER, hammer_mass_kg=0.005).parameters
    assert (string["hammer_mass_kg"]["initial"], string["strike_m"]["initial"]) == (0.005, 0.0744)


def test_long_calls_hear_an_interrupt():
    code = """
import signal, sys, time, contactspline as cs
calls = {"struck": lambda: cs.StruckString().play(1200), "score": lambda: cs.play_score(
    {"instrument": "trichord_c4", "duration_s": 600, "events": [{"time_s": i, "hammer_speed_m_per_s": 1} for i in range(600)],
     "voices": [{"name": f"v{i}"} for i in range(30)]})}
signal.signal(signal.SIGALRM, signal.getsignal(signal.SIGINT))
signal.setitimer(signal.ITIMER_REAL, 0.2)
try:
    calls[sys.argv[1]]()
except KeyboardInterrupt:
    print("heard")
"""
    for call in ("struck", "score"):
        done = subprocess.run([sys.executable, "-c", code, call], capture_output=True, text=True)
        assert done.stdout == "heard\n", done.stderr


def test_instruments_of_files_and_dicts(tmp_path):
    described = {"name": "probe", "description": "one mass on a spring",
                 "bodies": [{"name": "ball", "mass_kg": 0.01}]}
    with pytest.raises(cs.Error) as raised:
        cs.Instrument({**described, "wrong": 1})
    assert "wrong" in str(raised.value) and "\n" not in str(raised.value)
    with pytest.raises(cs.Error, match="no such instrument ships; allowed"):
        cs.Instrument("no_such")
    with pytest.raises(cs.Error, match=r"; did you mean hammer_string\?"):
        cs.Instrument("hammer-string")
    with pytest.raises(cs.Error, match="piano: resonator: unknown key; allowed: keyboard"):
        cs.Instrument("piano", resonator="string_c4")
    with pytest.raises(cs.Error, match="snare: resonator: is no part of this instrument; allowed: no keys"):
        cs.Instrument("snare", resonator="string_c4")
    with pytest.raises(cs.Error, match="hammer_string: wrong: unknown key; allowed: resonator"):
        cs.Instrument("hammer_string", **HAMMER, wrong=1)
    with pytest.raises(cs.Error, match="slide_string: INSTRUMENT: no such instrument ships"):
        cs.Instrument("slide_string", resonator="guitar_g3")
    own = {**HAMMER, "material": {"name": "probe", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 2},
                                  "impact": {"mass_kg": 0.003, "max_speed_m_per_s": 5, "min_speed_m_per_s": 0.5}, "spline": {"segments": 8, "knots": "uniform"}}}
    assert np.any(cs.Instrument("hammer_string", **own).play(cs.strike(0, 1), 0.1)["bridge_force_n"])


@pytest.mark.parametrize("wrong, told", [
    (dict(seconds=0), "seconds"), (dict(seconds=math.nan), "seconds"), (dict(sample_rate_hz=10), "sample_rate_hz"),
    (dict(parameters={"nothing": 1}), "nothing"), (dict(parameters={"damping_per_s": math.nan}), "damping_per_s"),
    (dict(parameters={"damping_per_s": np.zeros(9000)}), "damping_per_s"), (dict(outputs="nothing"), "nothing"),
    (dict(events=cs.strike(-1, 1)), "time"), (dict(events=cs.strike(0, math.nan)), "speed_m_per_s"),
    (dict(events=cs.strike(0, -1)), "speed_m_per_s"), (dict(events=cs.change(0, "loss_s_per_m", -1)), "loss_s_per_m"),
    (dict(parameters={"hammer_mass_kg": 1e9}), "hammer_mass_kg"), (dict(outputs=[]), "outputs"),
    (dict(events=cs.note(0, 60, 2)), "velocity"), (dict(events=cs.strike(1e300, 1)), "time"), (dict(energy_step=-1), "energy_step"),
    (dict(events=cs.strike(0, 2), parameters={"speed_m_per_s": 3}), "changes nothing"),
    (dict(events=cs.strike(0, 1, "nothing")), "strike"), (dict(events=cs.pluck(0, 1)), "pluck: it has none; allowed: strike, for strike"),
    (dict(events="strike"), "'strike' is no event; allowed: strike"), (dict(events=cs.strike(0.2, 1)), "0.2 s of an event is behind the end; allowed: 0 to 0.1 s"),
    (dict(events=cs.note(0, 200)), "key"), (dict(precision="half"), "precision")])
def test_what_is_wrong_is_told(wrong, told):
    with pytest.raises(cs.Error, match=told):
        made("hammer_string").play(**{"seconds": 0.1, **wrong})


@pytest.mark.parametrize("precision", ["single", "double"])
def test_the_contact_force_has_one_name(precision):
    string = made("hammer_string")
    sound = string.play(cs.strike(0, 2), 0.05, outputs=["force_n", "bridge_force_n"], force=False, precision=precision)
    assert list(sound.outputs) == ["bridge_force_n", "force_n"] and sound.units["force_n"] == "N"
    force = string.play(cs.strike(0, 2), 0.05, outputs="bridge_force_n", precision=precision)
    assert np.max(sound["force_n"]) > 1 and np.array_equal(sound["force_n"], force.force_n)
    assert np.array_equal(force["force_n"], force.force_n) and list(force.outputs) == ["bridge_force_n"]
    alone = string.play(cs.strike(0, 2), 0.05, outputs="force_n", precision=precision).samples
    many = cs.render_many(string, {"speed_m_per_s": [1.0, 2.0]}, cs.strike(0), 0.05, output="force_n", precision=precision)
    assert np.array_equal(many[1], alone.astype(np.float32)) and not np.array_equal(many[0], many[1])
    with pytest.raises(cs.Error, match="'force' is unknown; allowed: .*bridge_force_n, force_n$"):
        cs.render_many(string, {"speed_m_per_s": [1.0]}, cs.strike(0), 0.05, output="force")
    with pytest.raises(cs.Error, match="instrument: 'hammer_string' is none; allowed: an Instrument"):
        cs.render_many("hammer_string", {"speed_m_per_s": [1.0]}, cs.strike(0), 0.05)


def test_a_file_is_written_beside_those_of_others(tmp_path):
    (tmp_path / "diary").write_bytes(b"precious")
    (tmp_path / "a.wav.part").symlink_to("diary")
    made("hammer_string").play(cs.strike(0, 2), 0.01).write(tmp_path / "a.wav")
    assert (tmp_path / "diary").read_bytes() == b"precious" and (tmp_path / "a.wav.part").is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.wav", "a.wav.part", "diary"]


def test_sounds_are_written_drawn_and_shown(tmp_path, image_of):
    sound = made("hammer_string").play(cs.strike(0, 2), 0.2)
    sound.write(tmp_path / "a.wav", "bridge_force_n")
    with wave.open(str(tmp_path / "a.wav")) as file:
        assert (file.getframerate(), file.getnframes()) == (44100, 8820)
        samples = np.frombuffer(file.readframes(8820), "<i2").astype(float)
    assert np.max(np.abs(samples)) == round(32767 * 10 ** (-1 / 20))
    exact = sound["bridge_force_n"] / np.max(np.abs(sound["bridge_force_n"]))
    assert np.max(np.abs(samples / np.max(np.abs(samples)) - exact)) < 1.5e-4 / 2
    with pytest.raises(cs.Error, match="a.mp3: sound: its ending names no format that can be written; allowed: .wav"):
        sound.write(tmp_path / "a.mp3")
    assert [path.name for path in tmp_path.iterdir()] == ["a.wav"]
    line = sound.plot("bridge_force_n").get_lines()[0]
    assert np.array_equal(line.get_ydata(), sound["bridge_force_n"])
    for ask in (sound.wav, sound.plot, sound.__getitem__):
        with pytest.raises(cs.Error, match="'nothing' is unknown; allowed: .*bridge_force_n"):
            ask("nothing")
    assert "<audio" in sound._repr_html_() and "hammer" in made("hammer_string")._repr_html_()
    assert (image_of(sound) != image_of(made("hammer_string").play(cs.strike(0.1, 2), 0.2))).any()
    json.dumps(list(sound.units))
    for level in (6, math.nan, math.inf):
        with pytest.raises(cs.Error, match="level_db"):
            sound.wav(level_db=level)


def test_a_file_that_cannot_be_written_stays_as_it_was(tmp_path):
    code = """
import resource, sys, contactspline as cs
sound = cs.Instrument("mass_barrier", material="felt_c4").play(cs.strike(0, 2), 2)
resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))
import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
try:
    sound.write(sys.argv[1])
except OSError as error:
    print("told")
"""
    file = tmp_path / "a.wav"
    file.write_bytes(b"old content")
    done = subprocess.run([sys.executable, "-c", code, file], capture_output=True, text=True)
    assert done.stdout == "told\n", done.stderr
    assert file.read_bytes() == b"old content" and list(tmp_path.iterdir()) == [file]


def test_calls_leave_nothing_behind():
    code = """
import resource, contactspline as cs
string = cs.Instrument("hammer_string", resonator="string_c4", material="felt_c4")
for call in range(4000):
    string.play(cs.strike(0, 2), seconds=0.002)
    if call in (500, 3999):
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""
    early, late = map(int, subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())
    assert late - early < 1000  # kB: less than 300 bytes of each call


def test_a_file_is_written_beside_foreign_files_and_links(tmp_path):
    sound = cs.Instrument("tom").play(cs.strike(0), 0.01)
    precious = tmp_path / "precious.txt"
    precious.write_text("precious")
    (tmp_path / "x.wav.part").symlink_to(precious)
    (tmp_path / "y.wav.part").write_text("notes")
    (tmp_path / "y.wav").symlink_to(precious)
    for name in ("x.wav", "y.wav"):
        sound.write(tmp_path / name)
    assert precious.read_text() == "precious" and (tmp_path / "y.wav.part").read_text() == "notes"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["precious.txt", "x.wav", "x.wav.part", "y.wav", "y.wav.part"]
    assert (tmp_path / "x.wav").read_bytes() == (tmp_path / "y.wav").read_bytes() == sound.wav()
    mask = os.umask(0)
    os.umask(mask)
    assert (tmp_path / "x.wav").stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_folder_that_is_missing_is_an_error(tmp_path):
    sound = cs.Instrument("tom").play(cs.strike(0), 0.01)
    with pytest.raises(FileNotFoundError, match="gone does not exist; allowed: a folder that exists"):
        sound.write(tmp_path / "gone" / "x.wav")
    assert not list(tmp_path.iterdir())


def test_a_score_sets_the_level_of_its_sound():
    score = {"instrument": "tom", "duration_s": 0.05, "level_db": -20, "events": [{"time_s": 0, "stick_speed_m_per_s": 1}]}
    sound = cs.play_score(score)
    peak = {level: np.max(np.abs(np.frombuffer(sound.wav(level_db=level)[44:], "<i2"))) for level in (None, -1, -20)}
    assert peak[None] == peak[-20] == round(32767 * 10 ** -1)
    assert peak[-1] == round(32767 * 10 ** (-1 / 20))
