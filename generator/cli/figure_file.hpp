// SPDX-License-Identifier: MIT
// Files with figures: their formats, what they show, and which one replaces which.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace contactspline {

enum class FigureFormat { kSvg, kPng, kPdf };

/// What a figure shows. Every figure says it in its mark.
enum class FigureKind { kSpline, kKnots, kImpacts, kResonator, kInstrument, kSound, kFit, kFriction };

/// The format that the ending of a name chooses: .svg, .png or .pdf. Throws BadInput for any other.
[[nodiscard]] FigureFormat figure_format(const std::string& file);

/// The mark of the program, with the kind of the figure.
[[nodiscard]] std::string mark_of(FigureKind kind);

/// Throws BadInput if a file of this name is a figure of this program, of another kind, unless `force`: its name was
/// chosen twice, most likely.
void require_kind(const std::string& file, FigureKind kind, bool force);

/// Draws and writes a figure that was asked for. Throws BadInput as require_writable() and require_kind() do.
void write_figure(const std::string& file, FigureKind kind, std::span<const std::filesystem::path> inputs, bool force,
                  const std::function<std::string(FigureFormat)>& draw);

}  // namespace contactspline
