// SPDX-License-Identifier: MIT
#include "generator/spline/designed_materials.hpp"

#include "generator/material/material_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

const DesignedMaterials::Entry& DesignedMaterials::of(const JsonObject& object) {
  const NamedText named = read_named(object, "material", Shipped::kMaterials, read_);
  const std::pair key(named.file, named.ships);
  const std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(key); found != entries_.end()) return found->second;
  // A material's curve lies beside the material, wherever the naming file is.
  Material material = parse_material(named.text, named.file, reader_beside(named, read_));
  std::vector<Segment<double>> table = segment_table(design_spline(material, named.file));
  return entries_.emplace(key, Entry{std::move(material), std::move(table)}).first->second;
}

}  // namespace contactspline
