# SPDX-License-Identifier: MIT
"""A struck string as a differentiable function of PyTorch. Needs torch, which the package itself does not."""

from __future__ import annotations

from typing import Any

import torch

from .gradients import StruckString


class _Strike(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *args: Any, **kwargs: Any) -> tuple[torch.Tensor, torch.Tensor]:
        string, names, seconds, values = args
        ctx.string, ctx.names, ctx.type = string, names, values.dtype
        ctx.values = dict(zip(names, values.detach().double().tolist()))
        displacement, force = string.play(seconds, **ctx.values)
        return torch.from_numpy(displacement), torch.from_numpy(force)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, *grad_outputs: Any) -> tuple[Any, ...]:
        displacement, force = grad_outputs
        gradient = ctx.string.gradient(displacement.numpy(), force.numpy(), **ctx.values)
        return None, None, None, torch.tensor([gradient[name] for name in ctx.names], dtype=ctx.type)


def strike(string: StruckString, values: dict[str, torch.Tensor], seconds: float) -> tuple[torch.Tensor, torch.Tensor]:
    """Displacement [m] and force [N] of StruckString.play(), through which torch differentiates. values: scalars by the
    names of parameters."""
    names = list(values)
    return _Strike.apply(string, names, seconds, torch.stack([values[name] for name in names]))
