// SPDX-License-Identifier: MIT
// describe_lv2 NAME SUFFIX: lets the LV2 plug-in of the working folder, NAME.so or NAME.dll, write its description
// there.
#include <dlfcn.h>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  void* const plugin = dlopen(("./" + std::string(argv[1]) + argv[2]).c_str(), RTLD_NOW);
  void* const describe = plugin == nullptr ? nullptr : dlsym(plugin, "lv2_generate_ttl");
  if (describe == nullptr) {
    std::fprintf(stderr, "%s\n", dlerror());
    return 1;
  }
  reinterpret_cast<void (*)(const char*)>(describe)(argv[1]);
}
