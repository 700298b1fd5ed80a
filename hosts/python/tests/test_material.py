# SPDX-License-Identifier: MIT
import json
import math

import numpy as np
import pytest

import contactspline as cs

POWER_LAW = {"name": "probe", "contact": {"stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5},
             "impact": {"mass_kg": 0.003, "max_speed_m_per_s": 4, "min_speed_m_per_s": 0.5}, "spline": {"segments": 16, "knots": "uniform"}}


def duration(stiffness, exponent, mass, speed):
    """The closed form of a power law without loss: the integral of dy/v on the way in, twice."""
    order = exponent + 1
    compression = (order * mass * speed**2 / (2 * stiffness)) ** (1 / order)
    return 2 * compression / speed * math.sqrt(math.pi) * math.gamma(1 + 1 / order) / math.gamma(0.5 + 1 / order)


def test_a_power_law_has_the_closed_form():
    material = cs.Material(POWER_LAW)
    for speed in (0.5, 2.0, 4.0):
        impact = material.impact(speed)
        assert impact.contact_duration_s == pytest.approx(duration(4.5e9, 2.5, 0.003, speed), rel=1e-12)
        assert impact.exit_speed_m_per_s == speed
    y = np.array([[-1e-4, 0.0], [1e-4, 3e-4]])
    assert np.allclose(material.exact_force(y), 4.5e9 * np.maximum(y, 0) ** 2.5, rtol=1e-14, atol=0)


def test_segments_are_those_that_the_program_prints(program):
    printed = json.loads(program("inspect", "felt_c4", "--json").stdout)
    material = cs.Material("felt_c4")
    for name, array in {"knot_m": material.knots_m, "energy_j": material.energies_j, "force_n": material.forces_n,
                        "half_curvature_n_per_m": material.half_curvatures_n_per_m}.items():
        assert [segment[name] for segment in printed["segments"]] == list(array)
    assert material.errors == printed["errors"]
    knots = material.knots_m
    assert np.allclose(material.force(knots), material.forces_n, rtol=1e-12, atol=1e-12)
    assert np.allclose(material.potential(knots), material.energies_j, rtol=1e-12, atol=1e-18)
    for law in (material.force, material.potential, material.exact_force):
        assert np.array_equal(law([-np.inf, -1.0, 0.0]), [0.0, 0.0, 0.0])


def test_impacts_are_those_that_the_program_prints(program):
    printed = json.loads(program("impact", "felt_c2", "--speed", 2, "--rate", 44100, "--json").stdout)[0]["motions"]
    material = cs.Material("felt_c2")
    for motion in printed:
        impact = material.impact(2, of=motion["model"], sample_rate_hz=44100)
        for key in ("contact_duration_s", "max_compression_m", "exit_speed_m_per_s", "max_force_n"):
            assert getattr(impact, key) == motion[key], (motion["model"], key)


def test_impacts_of_arrays_are_those_of_their_numbers_and_print_a_table():
    material = cs.Material("felt_c2")
    speeds, masses = np.array([[0.5, 1.0, 4.0], [0.1, 2.0, 3.0]]), [0.003, 0.01, 0.002]
    for of in ("exact", "spline", "simulated"):
        impacts = material.impact(speeds, masses, of=of)
        for at in np.ndindex(speeds.shape):
            one = material.impact(speeds[at], masses[at[1]], of=of)
            for name, value in vars(one).items():
                assert getattr(impacts, name).shape == speeds.shape and getattr(impacts, name)[at] == value, (of, at, name)
    assert material.impact([]).max_force_n.shape == (0,)
    with pytest.raises(cs.Error, match="speed_m_per_s: nan is refused"):
        material.impact([1, math.nan])
    lines = [line.split() for line in str(material.impact(speeds[0])).splitlines()]
    assert lines[0] == ["speed_m_per_s", "mass_kg", "max_compression_m", "contact_duration_s", "exit_speed_m_per_s", "max_force_n"]
    for line, speed in zip(lines[1:], speeds[0], strict=True):
        assert [float(cell) for cell in line] == pytest.approx(list(vars(material.impact(speed)).values()), rel=1e-5)
    assert len(str(material.impact(1.0)).splitlines()) == 2


def test_keywords_files_and_dicts_describe_the_same(tmp_path):
    path = tmp_path / "probe.json"
    path.write_text(json.dumps(POWER_LAW))
    for material in (cs.Material(path), cs.Material(str(path)), cs.Material(POWER_LAW), cs.Material(**POWER_LAW)):
        assert np.array_equal(material.forces_n, cs.Material(POWER_LAW).forces_n)


def test_errors_are_the_lines_of_the_program(tmp_path, program):
    for change in ({"contact": {"stiffness_n_per_m_alpha": -1, "exponent": 2}}, {"unknown": 1}, {"name": "Not One"}):
        path = tmp_path / "bad.json"
        path.write_text(json.dumps({**POWER_LAW, **change}))
        run = program("inspect", path)
        assert run.returncode == 2
        with pytest.raises(cs.Error) as raised:
            cs.Material(path)
        assert f"contactspline: {raised.value}" == run.stderr.strip()
    with pytest.raises(cs.Error, match="no such material ships; allowed"):
        cs.Material("felt_c44")
    with pytest.raises(cs.Error, match="Out of range|not JSON compliant"):
        cs.Material(**{**POWER_LAW, "contact": {"stiffness_n_per_m_alpha": math.nan, "exponent": 2}})
    for wrong in (0, -1, math.nan, math.inf):
        with pytest.raises(cs.Error, match="speed_m_per_s"):
            cs.Material("felt_c4").impact(wrong)
        with pytest.raises(cs.Error, match="mass_kg"):
            cs.Material("felt_c4").impact(1, wrong)


def test_many_designs_are_those_of_one_by_one_in_order():
    dicts = [{**POWER_LAW, "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5 + 0.01 * i}} for i in range(40)]
    seen = []
    for threads in (1, 3):
        designed = cs.design_many(dicts, threads=threads, progress=lambda done, total: seen.append((done, total)))
        for material, source in zip(designed, dicts, strict=True):
            assert np.array_equal(material.forces_n, cs.Material(source).forces_n)
    assert all(0 <= done <= total == 40 for done, total in seen)
    with pytest.raises(cs.Error, match="unknown"):
        cs.design_many([POWER_LAW, {**POWER_LAW, "unknown": 1}])


def test_figures_show_the_material(image_of):
    material = cs.Material("felt_c4")
    lines = material.plot().get_lines()
    assert len(lines) == 3 and np.max(lines[0].get_ydata()) == pytest.approx(material.exact_force(material.end_m))
    assert len(material.plot_impacts()) == 2
    assert "felt" in material._repr_html_().lower() and "felt_c4" in repr(material)
    other = image_of(cs.Material("felt_c2"))
    assert image_of(material).shape == other.shape and (image_of(material) != other).any()
