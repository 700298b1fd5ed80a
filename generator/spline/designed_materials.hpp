// SPDX-License-Identifier: MIT
// The materials that a score or an instrument names, each with its spline.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "contactspline/step/contact.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/material/material.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Designs each material once, however often it is named. Several threads may ask.
class DesignedMaterials {
 public:
  struct Entry {
    Material material;
    std::vector<Segment<double>> table;
  };

  /// `read` reads the files that are named, and must outlive this.
  explicit DesignedMaterials(const ReadFile& read) : read_(read) {}

  /// The material that the key `material` of an object names. Throws BadInput.
  const Entry& of(const JsonObject& object);

 private:
  const ReadFile& read_;
  std::mutex mutex_;
  std::map<std::pair<std::string, bool>, Entry> entries_;
};

}  // namespace contactspline
