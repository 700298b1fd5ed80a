# SPDX-License-Identifier: MIT
"""Derivatives of struck strings: central differences, both directions, torch."""

import numpy as np
import pytest

import contactspline as cs

SECONDS = 0.05
FELTS = ["felt_c4", "felt_stulov_c4"]
SOFT = {"name": "soft", "contact": {"stiffness_n_per_m_alpha": 1e3, "exponent": 0.8},
        "impact": {"mass_kg": 0.003, "max_speed_m_per_s": 4, "min_speed_m_per_s": 0.5},
        "spline": {"knots": "graded", "segments": 20}}


def step_of(row):
    """A change whose effect is small, but far above rounding."""
    return 1e-6 * (row["initial"] if row["initial"] else 1)


@pytest.mark.parametrize("felt", FELTS)
def test_tangents_are_central_differences(felt):
    string = cs.StruckString(felt)
    slopes, of_force = string.tangents(SECONDS, string.parameters)
    assert slopes.shape == of_force.shape == (len(string.parameters), round(44100 * SECONDS))
    for i, (name, row) in enumerate(string.parameters.items()):
        if name == "loss_s_per_m":
            continue  # it begins at the end of its range
        h = step_of(row)
        above, below = (string.play(SECONDS, **{name: row["initial"] + sign * h}) for sign in (1, -1))
        for found, up, down in zip((slopes[i], of_force[i]), above, below):
            expected = (up - down) / (2 * h)
            # The rounding of samples, over the step; the table's kinks.
            bound = 1e-4 * np.abs(expected).max() + 1e-13 * np.abs(up).max() / h
            np.testing.assert_allclose(found, expected, rtol=0, atol=bound, err_msg=name)


@pytest.mark.parametrize("felt", FELTS)
def test_the_gradient_is_the_tangents_read_backwards(felt):
    string = cs.StruckString(felt)
    values = {"speed_m_per_s": 3.5, "loss_s_per_m": 0.05, "strike_m": 0.1, "exponent_change": 0.1}
    weights = np.random.default_rng(1).normal(size=(2, round(44100 * SECONDS)))
    gradient = string.gradient(*weights, **values)
    slopes, of_force = string.tangents(SECONDS, string.parameters, **values)
    assert list(gradient) == list(string.parameters)
    for i, name in enumerate(string.parameters):
        products = np.concatenate([weights[0] * slopes[i], weights[1] * of_force[i]])
        assert abs(gradient[name] - products.sum()) <= 1e-10 * np.abs(products).sum(), name
        assert np.abs(products).sum() > 0, name


def test_a_search_along_the_gradient_finds_a_felt():
    string = cs.StruckString()
    target, _ = string.play(SECONDS, stiffness_ratio=2.0)

    def error(log_ratio):
        displacement, _ = string.play(SECONDS, stiffness_ratio=float(np.exp(log_ratio)))
        return displacement - target

    log_ratio = 0.0
    for _ in range(30):  # Gauss and Newton
        ratio = float(np.exp(log_ratio))
        slope = string.tangents(SECONDS, "stiffness_ratio", stiffness_ratio=ratio)[0][0] * ratio
        log_ratio -= slope @ error(log_ratio) / (slope @ slope)
    assert abs(np.exp(log_ratio) - 2) < 1e-6


@pytest.mark.parametrize("call, says", [
    (lambda: cs.StruckString("felt_c4", "drum_head"), "drum_head: string: is no string"),
    (lambda: cs.StruckString(sample_rate_hz=float("nan")), "sample_rate_hz: nan is refused"),
    (lambda: cs.StruckString().play(0.1, speed=2), "'speed' is unknown; allowed: hammer_mass_kg"),
    (lambda: cs.StruckString().play(0.1, hammer_mass_kg=-1), "hammer_mass_kg: -1 is refused; allowed: 1e-06 to 100"),
    (lambda: cs.StruckString().play(0.1, string_tension_n=float("nan")), "string_tension_n: nan is refused"),
    (lambda: cs.StruckString(SOFT).play(0.1, exponent_change=-1), "exponent_change: with -1 the force would fall"),
    (lambda: cs.StruckString().play(0.1, strike_m=0.7), "strike_m: 0.7 is beyond the string; allowed: 0 to 0.62, its"),
    (lambda: cs.StruckString().tangents(0.1, ["speed_m_per_s"], pickup_m=1), "pickup_m: 1 is beyond the string"),
    (lambda: cs.StruckString().gradient(np.ones(3), strike_m=0.07, pickup_m=0.01, string_length_m=0.05),
     "strike_m: 0.07 is beyond the string; allowed: 0 to 0.05, its length, such as 0.05"),
    (lambda: cs.StruckString().play(-1), "seconds: -1 is refused"),
    (lambda: cs.StruckString().gradient(np.ones((2, 3))), "one row of samples"),
    (lambda: cs.StruckString().gradient(np.ones(3), np.ones(2)), "of one length")])
def test_wrong_calls_are_refused_in_one_line(call, says):
    with pytest.raises(cs.Error) as refused:
        call()
    assert says in str(refused.value) and "\n" not in str(refused.value)


def test_a_place_may_be_the_end_of_the_string():
    length = cs.StruckString().parameters["string_length_m"]["initial"]
    displacement, force = cs.StruckString().play(0.01, pickup_m=length)
    _, expected = cs.StruckString().play(0.01)
    assert np.abs(displacement).max() < 1e-12 and np.array_equal(force, expected) and force.max() > 1


def test_torch_refuses_a_second_derivative():
    torch = pytest.importorskip("torch", reason="python3-torch is not installed")
    from contactspline.torch import strike

    speed = torch.tensor(2.0, dtype=torch.float64, requires_grad=True)
    loss = (strike(cs.StruckString(), {"speed_m_per_s": speed}, 0.002)[1]**2).sum()
    plain, = torch.autograd.grad(loss, speed, retain_graph=True)
    first, = torch.autograd.grad(loss, speed, create_graph=True)
    assert first.item() == plain.item()
    with pytest.raises(RuntimeError, match="once_differentiable"):
        first.backward()


def test_torch_differentiates_through_it():
    torch = pytest.importorskip("torch", reason="python3-torch is not installed")
    from contactspline.torch import strike

    string = cs.StruckString()
    values = {"stiffness_ratio": torch.tensor(1.5, dtype=torch.float64, requires_grad=True),
              "speed_m_per_s": torch.tensor(2.0, dtype=torch.float64, requires_grad=True)}
    displacement, force = strike(string, values, 0.01)
    (1e6 * (displacement**2).sum() + force.max()).backward()
    plain = {name: float(value) for name, value in values.items()}
    d, f = string.play(0.01, **plain)
    largest = np.zeros_like(f)
    largest[f.argmax()] = 1
    expected = string.gradient(2e6 * d, largest, **plain)
    for name, value in values.items():
        assert value.grad.item() == pytest.approx(expected[name], rel=1e-12)
    assert torch.autograd.gradcheck(
        lambda ratio: strike(string, {"stiffness_ratio": ratio}, 0.002)[1], values["stiffness_ratio"], eps=1e-5, atol=1e-3)


def test_motion_is_the_displacement_at_each_place():
    string = cs.StruckString()
    axes = string.plot_motion(0.002, places=5, speed_m_per_s=3)
    motion = axes.get_images()[0].get_array()
    assert motion.shape == (5, 88) and np.abs(motion).max() > 0.1  # mm
    for row, place in zip(motion, np.linspace(0, 0.62, 5)):
        assert np.array_equal(row, 1000 * string.play(0.002, speed_m_per_s=3, pickup_m=place)[0])
    *_, low, high = axes.get_images()[0].get_extent()
    assert np.allclose([low, high], [-0.0775, 0.6975]) and np.allclose(axes.get_ylim(), [0, 0.62])
    for wrong, line in (({"places": 1}, "places: 1 is refused"), ({"pickup_m": 0.1}, "pickup_m: is refused")):
        with pytest.raises(cs.Error, match=line):
            string.plot_motion(**wrong)
