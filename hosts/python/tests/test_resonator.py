# SPDX-License-Identifier: MIT
import json
import math

import numpy as np
import pytest

import contactspline as cs

STRING = {"name": "probe", "string": {"length_m": 0.8, "mass_kg": 0.004, "tension_n": 500, "bending_stiffness_n_m2": 0.01,
                                      "constant_loss_per_s": 0.5, "quadratic_loss_m2_per_s": 1e-4},
          "strike": {"position_m": 0.1}, "pickup": {"position_m": 0.3}}


def test_a_stiff_string_has_the_closed_form():
    string = cs.Resonator(STRING)
    n = np.arange(1, len(string.frequencies_hz) + 1)
    wavenumber = n * math.pi / 0.8
    undamped = wavenumber * np.sqrt((500 + 0.01 * wavenumber**2) / 0.005)
    decay = 0.5 + 1e-4 * wavenumber**2
    assert len(n) > 30 and string.frequencies_hz[-1] < 22050
    np.testing.assert_allclose(string.decays_per_s, decay, rtol=1e-13)
    np.testing.assert_allclose(string.frequencies_hz, np.sqrt(undamped**2 - decay**2) / (2 * math.pi), rtol=1e-13)
    np.testing.assert_allclose(string.masses_kg, 0.002, rtol=1e-13)
    assert len(cs.Resonator(STRING, sample_rate_hz=8000).frequencies_hz) < len(n)


@pytest.mark.parametrize("name", cs.shipped("resonators"))
def test_modes_are_those_that_the_program_prints(program, name, image_of):
    printed = json.loads(program("inspect", name, "--json").stdout)
    resonator = cs.Resonator(name)
    for key, array in {"frequency_hz": resonator.frequencies_hz, "decay_per_s": resonator.decays_per_s,
                       "mass_kg": resonator.masses_kg}.items():
        assert [mode[key] for mode in printed["modes"]] == list(array) and len(array) > 1
    assert resonator.modes_left_out == printed["modes_left_out"] and name in repr(resonator)
    assert np.array_equal(resonator.plot().get_lines()[-1].get_ydata(), resonator.decays_per_s)
    assert image_of(resonator).min() < image_of(resonator).max()


def test_keys_are_those_that_the_program_prints(program):
    printed = json.loads(program("inspect", "piano", "--json").stdout)
    piano = cs.Keyboard("piano")
    assert list(piano.keys) == list(range(21, 109)) and len(printed["keys"]) > 2
    for row in printed["keys"]:
        assert piano.keys[row["key"]] == {name: value for name, value in row.items() if name != "key"}
    # In equal temperament by six digits of the tension.
    np.testing.assert_allclose(piano.column("pitch_hz"), 440 * 2 ** ((np.arange(21, 109) - 69) / 12), rtol=1e-5)
    assert "88" in repr(piano) and "to 108" in piano._repr_html_()


def test_files_and_dicts_describe_the_same(tmp_path):
    (tmp_path / "probe.json").write_text(json.dumps(STRING))
    assert np.array_equal(cs.Resonator(tmp_path / "probe.json").frequencies_hz, cs.Resonator(STRING).frequencies_hz)


def test_errors_are_one_line(program, tmp_path):
    path = tmp_path / "probe.json"
    path.write_text(json.dumps({**STRING, "unknown": 1}))
    with pytest.raises(cs.Error) as raised:
        cs.Resonator(path)
    assert f"contactspline: {raised.value}" == program("inspect", path).stderr.strip()
    for call, says in ((lambda: cs.Resonator("felt_c4"), "is no resonator; allowed: .*such as string_c4"),
                       (lambda: cs.Keyboard("string_c4"), "is no keyboard; allowed: .*such as piano"),
                       (lambda: cs.Resonator(STRING, sample_rate_hz=math.nan), "sample_rate_hz: nan is refused"),
                       (lambda: cs.Keyboard({"name": "probe"}), "missing"),
                       (lambda: cs.Keyboard("piano").column("nothing"), "'nothing' is unknown; allowed: pitch_hz")):
        with pytest.raises(cs.Error, match=says):
            call()
