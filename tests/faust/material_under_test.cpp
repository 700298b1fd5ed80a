// SPDX-License-Identifier: MIT
#include "material_under_test.hpp"

namespace contactspline::testing {
namespace {

std::vector<MaterialUnderTest>& registry() {
  static std::vector<MaterialUnderTest> materials;
  return materials;
}

}  // namespace

const std::vector<MaterialUnderTest>& materials_under_test() {
  return registry();
}

bool register_material(MaterialUnderTest material) {
  const auto place = std::ranges::lower_bound(registry(), material.name, {}, &MaterialUnderTest::name);
  registry().insert(place, std::move(material));
  return true;
}

}  // namespace contactspline::testing
