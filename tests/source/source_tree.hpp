// SPDX-License-Identifier: MIT
// The source tree as text, for tests of its structure and its words.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace contactspline::testing {

namespace fs = std::filesystem;

struct SourceFile {
  std::string path;  ///< relative to the tree, with slashes
  std::string text;
};

inline std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every file below these folders of the tree that has one of the endings, by rising path.
inline std::vector<SourceFile> source_files(const std::vector<std::string>& folders,
                                            const std::vector<std::string>& endings) {
  std::vector<SourceFile> files;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOURCE_FOLDER) / folder)) {
      const std::string ending = entry.path().extension().string();
      if (!entry.is_regular_file() || std::ranges::find(endings, ending) == endings.end()) continue;
      files.push_back({fs::relative(entry.path(), SOURCE_FOLDER).generic_string(), text_of(entry.path())});
    }
  std::ranges::sort(files, {}, &SourceFile::path);
  return files;
}

}  // namespace contactspline::testing
