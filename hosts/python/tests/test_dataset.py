# SPDX-License-Identifier: MIT
"""Data sets: what the files hold, and docs/how-to/datasets.md."""

import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest

import contactspline as cs

PAGE = (pathlib.Path(__file__).parents[3] / "docs/how-to/datasets.md").read_text()
PROGRAMS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
PLAN = {"name": "probe", "description": "Größe", "instrument": "hammer_string", "parts": {"resonator": "string_c4", "material": "felt_c4"},
        "parameters": {"speed_m_per_s": {"logarithmic": [0.5, 5]}, "hammer_mass_kg": {"uniform": [0.002, 0.012]},
                       "stiffness_ratio": {"table": [0.5, 1, 2]}},
        "events": [{"time_s": 0.001, "event": "strike", "hold_s": 0.02}, {"time_s": 0.03, "parameter": "damping_per_s", "to": 20}],
        "outputs": ["bridge_force_n", "displacement_m", "force_n", "energy_j"], "energy_step_samples": 100,
        "sequence": "sobol", "seed": 3, "count": 65, "seconds": 0.05}


ZITHER = {"name": "zither",
          "bodies": [{"name": "string", "resonator": "string_c4"}, {"name": "hammer", "mass_kg": 0.003}],
          "places": [{"name": "struck", "body": "string", "position_m": 0.0744}],
          "contacts": [{"name": "felt", "between": ["hammer", "struck"], "material": "felt_c4"}],
          "strikes": ["hammer"], "keys": [{"first": 48, "last": 72, "event": "strike_hammer", "tuned_key": 60}],
          "polyphony": 2, "damper": {"bodies": "string", "damping_per_s": 60},
          "outputs": [{"name": "string", "end_force_n": "string"}]}


def content(path):
    """All arrays of a file by name, with their units."""
    arrays = {}
    with h5py.File(path) as file:
        for group in ("parameters", "outputs"):
            for name, array in file[group].items():
                arrays[f"{group}/{name}"] = (array[:].tobytes(), array.shape, array.dtype.str, array.attrs["unit"])
    return arrays


def test_samples_do_not_depend_on_shards_and_threads(tmp_path):
    whole = content(cs.dataset(PLAN, tmp_path / "1"))
    for shards, threads in ((7, 1), (64, 2)):
        lines = []
        path = cs.dataset(PLAN, tmp_path / str(shards), shards=shards, threads=threads, report=lines.append)
        assert len(lines) == shards + 2 and lines[-1] == f"joined {path}"
        assert content(path) == whole
    shards = []
    for shard in (3, 1, 2):
        shards.append(cs.dataset(PLAN, tmp_path / "3", shards=3, shard=shard))
        assert shards[-1].endswith(f"probe-0000{shard}-of-00003.h5")
    assert content(cs.dataset(PLAN, tmp_path / "3", shards=3)) == whole


def test_a_sample_is_what_the_instrument_plays(tmp_path):
    path = cs.dataset(PLAN, tmp_path, shards=2)
    string = cs.Instrument("hammer_string", **PLAN["parts"])
    with h5py.File(path) as file:
        assert file.attrs["samples"] == 65 and file.attrs["first_sample"] == 0 and file.attrs["sample_rate_hz"] == 44100
        assert file.attrs["program"].decode().endswith(f"contactspline {cs._core.__version__}")
        assert json.loads(file.attrs["plan"]) == PLAN and file.attrs["instrument"] == b"hammer_string"
        assert file.attrs["description"].decode() == PLAN["description"]
        units = {name: array.attrs["unit"].decode() for name, array in file["outputs"].items()}
        assert units == {"bridge_force_n": "N", "displacement_m": "m", "force_n": "N", "energy_j": "J"}
        for i in (0, 32, 33, 64):
            values = {name: file["parameters"][name][i] for name in ("speed_m_per_s", "hammer_mass_kg", "stiffness_ratio")}
            assert 0.5 < values["speed_m_per_s"] < 5 and values["stiffness_ratio"] == (0.5, 1, 2)[i % 3]
            sound = string.play([cs.strike(0.001, values["speed_m_per_s"], hold_s=0.02), cs.change(0.03, "damping_per_s", 20)],
                                0.05, parameters=values, precision="single", energy_step=100)
            for name in ("bridge_force_n", "displacement_m"):
                assert np.array_equal(file["outputs"][name][i], sound[name]) and np.any(sound[name] != 0)
            assert np.array_equal(file["outputs/force_n"][i], sound.force_n)
            assert np.array_equal(file["outputs/energy_j"][i], sound.energy_j)


def test_keys_take_tables_and_velocities_distributions(tmp_path):
    plan = {"name": "keys", "instrument": ZITHER, "seed": 1, "count": 4, "seconds": 0.05, "outputs": ["string_end_force_n"],
            "events": [{"time_s": 0, "key": {"table": [60, 64]}, "velocity": {"uniform": [0.3, 1]}, "hold_s": 0.02}]}
    with h5py.File(cs.dataset(plan, tmp_path)) as file:
        keys, velocities = file["parameters/events[0].key"][:], file["parameters/events[0].velocity"][:]
        assert keys.tolist() == [60, 64, 60, 64] and len(set(velocities)) == 4
        for i in range(4):
            sound = cs.Instrument(ZITHER).play(cs.note(0, int(keys[i]), velocities[i], 0.02), 0.05, precision="single")
            assert np.array_equal(file["outputs/string_end_force_n"][i], sound["string_end_force_n"])
            assert sound["string_end_force_n"].any()


def test_plans_have_the_piano_and_parts_as_objects(tmp_path):
    shipped = pathlib.Path(__file__).parents[3] / "data"
    without_comments = re.sub(r"^ *//.*$", "", (shipped / "materials/felt_c4.json").read_text(), flags=re.MULTILINE)
    felt = {**json.loads(without_comments), "name": "stiff", "contact": {"stiffness_n_per_m_alpha": 9e9, "exponent": 2.5}}
    strike, key = {"time_s": 0, "event": "strike"}, {"time_s": 0, "key": 60, "velocity": 0.5}
    common = {"name": "one", "seed": 1, "count": 1, "seconds": 0.05}
    speed = {"speed_m_per_s": 2}
    cases = [({"instrument": "hammer_string", "parts": {"resonator": "string_c4", "material": felt}, "parameters": speed},
              strike, cs.strike(0)),
             ({"instrument": "mass_barrier", "parts": {"material": felt}, "parameters": speed},
              {"time_s": 0, "event": "throw"}, cs.strike(0)),
             ({"instrument": "piano"}, key, cs.note(0, 60, 0.5)),
             ({"instrument": "piano", "parts": {"keyboard": "piano"}}, key, cs.note(0, 60, 0.5))]
    for number, (made, event, played) in enumerate(cases):
        # cs.Instrument("piano") is compiled from constants of 13 digits; a plan reads the keyboard file.
        parts = {"keyboard": "piano"} if made["instrument"] == "piano" else made["parts"]
        source = cs.Instrument(made["instrument"], **parts)
        plan = {**common, **made, "events": [event], "outputs": list(source.outputs)}
        with h5py.File(cs.dataset(plan, tmp_path / str(number))) as file:
            sound = source.play(played, 0.05, parameters=made.get("parameters", {}), precision="single")
            for name in source.outputs:
                assert np.array_equal(file[f"outputs/{name}"][0], sound[name]) and sound[name].any(), made["instrument"]
    with pytest.raises(cs.Error, match="plan: parts.material: contact.stiffness: unknown key"):
        cs.dataset({**common, **cases[1][0], "parts": {"material": {**felt, "contact": {"stiffness": 1}}},
                    "events": [cases[1][1]], "outputs": ["displacement_m"]}, tmp_path / "refused")
    with pytest.raises(cs.Error, match="plan: parts.material: is a resonator; allowed: a .json file"):
        cs.dataset({**common, **cases[1][0], "parts": {"material": {"string": {}}}, "events": [cases[1][1]],
                    "outputs": ["displacement_m"]}, tmp_path / "refused")


def test_joined_file_is_read_from_any_folder_and_misses_no_shard_in_silence(tmp_path, monkeypatch):
    path = pathlib.Path(cs.dataset(PLAN, tmp_path / "set", shards=4))
    whole = content(path)
    moved = tmp_path / "moved"
    path.parent.rename(moved)
    monkeypatch.chdir("/")
    assert content(moved / path.name) == whole
    (moved / "probe-00002-of-00004.h5").unlink()
    with h5py.File(moved / path.name) as file:
        missing = file["outputs/force_n"][20]
        assert np.all(np.isnan(missing)) and not np.any(np.isnan(file["outputs/force_n"][40]))
    shard = moved / "probe-00003-of-00004.h5"
    shard.write_bytes(shard.read_bytes()[:-1])
    with h5py.File(moved / path.name) as file:
        assert np.all(np.isnan(file["outputs/force_n"][40])) and not np.any(np.isnan(file["outputs/force_n"][0]))


def test_a_changed_byte_is_found_by_any_reader(tmp_path):
    path, joined = pathlib.Path(cs.dataset(PLAN, tmp_path, shards=1, shard=1)), cs.dataset(PLAN, tmp_path, shards=1)
    with h5py.File(path) as file:
        place = file["outputs/bridge_force_n"].id.get_chunk_info(0).byte_offset
    damaged = bytearray(path.read_bytes())
    damaged[place + 100] ^= 1
    path.write_bytes(damaged)
    for name in (path, joined):
        with h5py.File(name) as file, pytest.raises(OSError):
            file["outputs/bridge_force_n"][:]
    lines = []
    cs.dataset(PLAN, tmp_path, shards=1, shard=1, report=lines.append)
    assert lines[-1] == f"wrote {path}"


def test_errors_are_the_lines_of_the_program(tmp_path):
    with pytest.raises(cs.Error, match="plan: count: 0 is out of range; allowed: an integer from 1"):
        cs.dataset({**PLAN, "count": 0}, tmp_path)
    with pytest.raises(cs.Error, match="allowed: 1 to 99999"):
        cs.dataset(PLAN, tmp_path, shards=2, shard=3)
    assert not list(tmp_path.iterdir())


def test_a_report_has_the_shards_that_fail(tmp_path):
    for i in (1, 3):
        (tmp_path / f"probe-0000{i}-of-00003.h5").write_text("a diary")
    lines = []
    with pytest.raises(cs.Error, match="probe-00003-of-00003.h5: file: cannot be read.*2 of 3 shards failed"):
        cs.dataset(PLAN, tmp_path, shards=3, report=lines.append)
    assert lines[-2] == f"wrote {tmp_path}/probe-00002-of-00003.h5"
    assert "probe-00001-of-00003.h5: file: cannot be read" in lines[-1]


def test_an_interrupt_stops_it_and_leaves_nothing(tmp_path):
    plan = {"name": "slow", "instrument": "trichord_c4", "seed": 1, "count": 50000, "seconds": 0.05,
            "events": [{"time_s": 0, "event": "strike_hammer"}], "outputs": ["bridge_force_n"]}
    code = f"import contactspline as cs; cs.dataset({plan!r}, 'out')"
    running = subprocess.Popen([sys.executable, "-c", code], cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    for _ in range(600):
        if list(tmp_path.glob("out/*.part")):
            break
        time.sleep(0.1)
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    assert "KeyboardInterrupt" in running.communicate(timeout=60)[1]
    assert not list(tmp_path.glob("out/*"))


def test_programs_of_the_page_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "strikes.json").write_text(re.search(r"^```json\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1])
    commands = re.search(r"^```sh\n(contactspline dataset.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1]
    subprocess.run([os.environ["CONTACTSPLINE_PROGRAM"], *commands.split()[1:]], check=True)
    assert len(PROGRAMS) == 3
    for program in PROGRAMS:
        if "torch" in program:  # below
            continue
        exec(compile(program, "page", "exec"), {})
        assert capsys.readouterr().out.strip()
    (tmp_path / "strikes/strikes-00001-of-00004.h5").unlink()
    with pytest.raises(AssertionError, match="its shard is missing"):
        exec(compile(PROGRAMS[0], "page", "exec"), {})


def test_torch_program_of_the_page_runs(tmp_path, monkeypatch, capsys):
    pytest.importorskip("torch", reason="python3-torch is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "strikes.json").write_text(re.search(r"^```json\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1])
    cs.dataset("strikes.json", "strikes")
    exec(compile(next(program for program in PROGRAMS if "torch" in program), "page", "exec"), {})
    assert "torch.Size([8, 22050])" in capsys.readouterr().out
    (tmp_path / "strikes/strikes-00001-of-00001.h5").unlink()
    with pytest.raises(AssertionError, match="the shard of sample 0 is missing"):
        exec(compile(next(program for program in PROGRAMS if "torch" in program), "page", "exec"), {})
