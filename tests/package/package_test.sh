#!/usr/bin/env bash
# package_test.sh CASE: builds and runs a project outside the tree. The environment says where: SOURCE is the tree,
# BUILD its build tree, INSTALLED what case install has installed of it, WORK a folder of the test's own, made anew.
set -euo pipefail

# ccache takes the same file in another build folder, or in the next run, for the same.
export CCACHE_BASEDIR="$WORK" CCACHE_SLOPPINESS=pch_defines,time_macros

# Ends the test with what was wrong and the log of the last command.
fail() {
  printf 'FAIL: %s\n' "$*" >&2
  [ ! -f "$WORK/log" ] || sed 's/^/    /' "$WORK/log" >&2
  exit 1
}

# Runs a command with its output in the log.
run() {
  "$@" >"$WORK/log" 2>&1 || fail "$* exits $?"
}

# Skips the test where a program is missing.
need() {
  command -v "$1" >/dev/null || { echo "skipped: $1 is not installed"; exit 77; }
}

# Installs into a prefix and moves it, so that whatever is used afterwards has been relocated.
case_install() {
  run cmake --install "$BUILD" --prefix "$WORK/first prefix"
  rm -rf "$INSTALLED"
  mv "$WORK/first prefix" "$INSTALLED"
  ! grep -rIlF -e "$SOURCE" -e "$BUILD" "$INSTALLED" || fail "what is installed names the folder it came from"
}

# A prefix of the case's own with what is installed, whose files are the same as those of the other cases.
install_at() {
  mkdir -p "$(dirname "$1")"
  cp -al "$INSTALLED" "$1"
}

# Configures $project in $build with a generator and further arguments.
configure() {
  run cmake -S "$project" -B "$build" -G "$@"
}

# Builds $build; the output is in the log.
build() {
  run cmake --build "$build" --parallel "$(nproc)"
}

# Fails unless the last build did (or, with "no", did not do) a step.
expect_step() {
  if [ "$1" = no ]; then
    ! grep -qE "$2" "$WORK/log" || fail "did what it need not: $2"
  else
    grep -qE "$1" "$WORK/log" || fail "did not do: $1"
  fi
}

# A build after which nothing is left to do.
expect_current() {
  build
  expect_step no 'Generating|Building|Linking|Re-running'
}

# Runs the consumer; it compares contact durations with the closed form.
expect_right_durations() {
  "$build/consumer" >"$WORK/durations" || fail "durations are off: $(cat "$WORK/durations")"
  cat "$WORK/durations"
}

# Largest of the numbers in a column of standard input, within 1 % of the closed form k ym^a of F = k y^a.
# expect_peak_force COLUMN K A MASS SPEED
expect_peak_force() {
  awk -v column="$1" -v k="$2" -v a="$3" -v m="$4" -v v="$5" '
    $column + 0 > peak { peak = $column + 0 }
    END {
      exact = k * ((a + 1) * m * v * v / (2 * k)) ^ (a / (a + 1))
      printf "largest force %g N, closed form %g N\n", peak, exact
      exit !(peak > 0.99 * exact && peak < 1.01 * exact)
    }' || fail "the largest force is off"
}

# A code block of the README or of another page, by language.
readme_block() {
  awk -v begin="\`\`\`$1" '$0 == begin { on = 1; next } /^```/ { on = 0 } on' "$SOURCE/${2-README.md}"
}

# The program of the README: its second block of C++. The first plays the piano.
readme_program() {
  awk '/^```cpp$/ { on = ++count == 2; next } /^```/ { on = 0 } on' "$SOURCE/README.md"
}

# What contactspline_generate has to do however it is reached. exercise GENERATOR CMAKE_ARGUMENT...
exercise() {
  local generated="$build/materials/project_materials/cork.hpp" sounds="$build/materials/sounds"
  local cork="$project/materials/cork.json" bead="$project/materials/bead.json"
  cp "$SOURCE"/tests/package/project/materials/*.json "$project/materials"
  configure "$@"
  build
  expect_right_durations
  for file in bead.lib bead.json felt_c7.lib felt_c7.json; do [ -f "$sounds/$file" ] || fail "no $file"; done
  [ -f "$(cat "$build/faust_folder")/contactspline.lib" ] && [ -f "$(cat "$build/faust_folder")/felt_c4.lib" ] ||
    fail "ContactSpline_FAUST_DIR lacks a library"
  expect_current

  cp "$WORK/durations" "$WORK/durations before"
  sed -i 's/2e7/8e7/' "$cork"
  build
  grep -q 'stiffness_n_per_m_alpha = 80000000.0;' "$generated" || fail "a changed value leaves the header as it was"
  expect_right_durations
  ! diff -q "$WORK/durations before" "$WORK/durations" >/dev/null || fail "the program was not built again"
  expect_current

  echo '// Still cork.' >>"$cork"
  build
  expect_step 'Generating material cork'
  [ "$1" != Ninja ] || expect_step no 'Building'
  expect_current

  rm "$generated"
  build
  [ -f "$generated" ] || fail "a header that was removed is not made again"
  expect_current

  sed -i 's/"bead"/"pearl"/' "$bead"
  build
  [ -f "$sounds/pearl.lib" ] || fail "a renamed material keeps its old file names"
  expect_current
}

find_package() {
  cp -r "$SOURCE/tests/package/project" "$WORK/the project"
  project="$WORK/the project" build="$WORK/the build"
  install_at "$WORK/moved prefix"
  exercise "$1" "-DCMAKE_PREFIX_PATH=$WORK/moved prefix"
  local program="$WORK/moved prefix/bin/contactspline"
  rm "$program"
  cp "$INSTALLED/bin/contactspline" "$program"
  build
  expect_step 'Generating material felt_c7'
  expect_current
}

case_find_package_ninja() { find_package Ninja; }
case_find_package_make() { find_package 'Unix Makefiles'; }

# From a copy, so that a template can be changed; without the tests, which a user does not build. With Ninja only: the
# whole program is built here, each library as one file, and find_package_make runs the same steps with make. Without
# assertions, as no other test builds it, and without a warning.
case_add_subdirectory() {
  local tree="$WORK/source tree"
  cp -r "$SOURCE/tests/package/project" "$WORK/the project"
  mkdir "$tree"
  tar -C "$SOURCE" --exclude=./.git --exclude=./tests --exclude=./build --exclude=".${BUILD#"$SOURCE"}" -cf - . |
    tar -C "$tree" -xf -
  project="$WORK/the project" build="$WORK/the build"
  exercise Ninja "-DCONTACTSPLINE_SOURCE=$tree" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCONTACTSPLINE_BUILD_DATASETS=ON "-DCMAKE_CXX_FLAGS=-DNDEBUG -Werror"
  echo '// A template of my own.' >>"$tree/templates/material.lib.in"
  build
  tail -n 1 "$build/materials/sounds/felt_c7.lib" | grep -qx '// A template of my own.' ||
    fail "a changed template leaves the generated files as they were"
  expect_current
}

# Only the headers and the materials that ship, from source: without any library of the program, as they are found
# nowhere. By add_subdirectory and by FetchContent.
# Windows.h and Arduino.h define min and max as macros: all headers that users include, and all that are emitted,
# compile after them.
case_macros() {
  local headers system
  headers=$(cd "$SOURCE/runtime" && find contactspline* -name '*.hpp' ! -name '*-inl.hpp'
    cd "$BUILD/include" && find contactspline -name '*.hpp')
  [ "$(wc -l <<<"$headers")" -gt 120 ] || fail "too few headers"
  system=$(cd "$SOURCE/runtime" && grep -rhoE '^#include <[^>]+>' . | grep -v '<hwy/' | sort -u)
  sed -E 's/#include (.*)/#if __has_include(\1)\n&\n#endif/' <<<"$system" >"$WORK/macros.cpp"
  echo '#include "hosts/c/contactspline.h"
#define min(a, b) ((a) < (b) ? (a) : (b))
#define max(a, b) ((a) > (b) ? (a) : (b))' >>"$WORK/macros.cpp"
  sed 's/.*/#include "&"/' <<<"$headers" >>"$WORK/macros.cpp"
  run "$CXX" -std=c++20 -fsyntax-only -I "$SOURCE/runtime" -I "$BUILD/include" -I "$SOURCE" "$WORK/macros.cpp"
}

case_headers_only() {
  project="$WORK/the project"
  mkdir "$project"
  readme_program >"$project/main.cpp"
  local without=() package
  for package in Boost CLI11 Eigen3 GTest PkgConfig TBB fmt hwy nlohmann_json; do
    without+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON")
  done
  local add_subdirectory='add_subdirectory("${CONTACTSPLINE_SOURCE}" contactspline)'
  local fetch_content='include(FetchContent)
FetchContent_Declare(ContactSpline SOURCE_DIR "${CONTACTSPLINE_SOURCE}")
FetchContent_MakeAvailable(ContactSpline)'
  local taken
  for taken in "$add_subdirectory" "$fetch_content"; do
    build="$WORK/build ${taken:0:6}"
    echo "cmake_minimum_required(VERSION 3.25)
project(HeadersOnly LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 17)
$taken
add_executable(hammer main.cpp)
target_link_libraries(hammer PRIVATE ContactSpline::materials)
if(GENERATE)
  contactspline_generate(TARGET t MATERIALS felt_c4)
endif()" >"$project/CMakeLists.txt"
    configure Ninja "-DCONTACTSPLINE_SOURCE=$SOURCE" "${without[@]}"
    build
    "$build/hammer" | expect_peak_force 3 4.5e9 2.5 0.003 2
    ! cmake "$build" -DGENERATE=ON >"$WORK/log" 2>&1 || fail "contactspline_generate works without the program"
    tr -s ' \n' ' ' <"$WORK/log" |
      grep -qF 'contactspline_generate: the program is not built; allowed: set(CONTACTSPLINE_BUILD_GENERATOR ON)' ||
      fail "contactspline_generate is silent about the program"
  done
  ! cmake -S "$SOURCE" -B "$WORK/tests" -DCONTACTSPLINE_BUILD_GENERATOR=OFF >"$WORK/log" 2>&1 ||
    fail "the tests are built without the program"
  grep -q 'CONTACTSPLINE_BUILD_TESTS needs the program' "$WORK/log" || fail "is silent about the tests"
}

# The public headers of the runtime below a folder, by their names in an #include.
public_headers() {
  (cd "$1" && find contactspline.hpp contactspline/{step,simd,modal,network,models,tangent,instrument,host} -name '*.hpp' \
    ! -name '*-inl.hpp' | sort)
}

# Every public header under C++17: the first error says what is missing, and nothing but it is said. A target that
# links the library is compiled as C++20 (case headers_only asks for C++17 there).
case_cpp17() {
  install_at "$WORK/prefix"
  local header compiler
  for compiler in $(command -v "$CXX" g++ clang++ | xargs readlink -f | sort -u); do
    for header in $(public_headers "$WORK/prefix/include"); do
      echo "#include \"$header\"" >"$WORK/user.cpp"
      ! "$compiler" -std=c++17 -fsyntax-only -I"$WORK/prefix/include" "$WORK/user.cpp" >"$WORK/log" 2>&1 ||
        fail "$header compiles as C++17"
      grep 'error' "$WORK/log" | head -n 1 | grep -q 'Contact Spline needs C++20: compile with -std=c++20' ||
        fail "$compiler says something else of $header first"
      [ "$(grep -c 'error: ' "$WORK/log")" = 2 ] || fail "$compiler says more of $header"  # #error, and where it stops
    done
  done
}

# Prints the headers that are named, of the working folder, each with the last one of the list $1 that it includes, if any: itself
# or by other headers, whatever is defined.
what_they_include() {
  awk -v large="$1" '
    function includes(header, other, key, names, n, i) {
      key = header " " other
      if (key in known) return known[key]
      n = split(included[header], names)
      for (i = 1; i <= n && !known[key]; ++i) known[key] = names[i] == other || includes(names[i], other)
      return known[key]
    }
    FNR == 1 { headers[++count] = FILENAME; depth = 0 }
    /^#if/ { ++depth }
    /^#endif/ { --depth }
    depth == 0 && /^#include "/ { split($0, name, "\""); included[FILENAME] = included[FILENAME] " " name[2] }
    END {
      sizes = split(large, others)
      for (i = 1; i <= count; ++i) {
        for (k = sizes; k > 0 && !includes(headers[i], others[k]); --k) {}
        print headers[i], (k > 0 ? others[k] : "")
      }
    }' "${@:2}"
}

# Every public and every emitted header alone by clang++: what it includes of `large` is compiled once, alone too. All of them
# together and every template of theirs, by both compilers. Without a warning.
case_warnings() {
  install_at "$WORK/prefix"
  need g++
  need clang++
  local include="$WORK/prefix/include" compiler header headers included precompiled
  local options=(-std=c++20 -Werror -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wsign-conversion -Wdouble-promotion "-I$include")
  local templates="$SOURCE/tests/package/every_template.cpp"
  local large="contactspline/step/contact.hpp contactspline/data/string_parts.hpp contactspline/instrument/network_instrument.hpp"
  for header in $large; do
    run clang++ "${options[@]}" -x c++-header "$include/$header" -o "$WORK/${header##*/}.pch"
  done
  mapfile -t headers < <(cd "$include" && find contactspline.hpp contactspline -name '*.hpp' ! -name '*-inl.hpp' | sort)
  (cd "$include" && what_they_include "$large" "${headers[@]}") >"$WORK/headers"
  printf '#include <faust/gui/%s.h>\n' UI meta >"$WORK/all.hpp"
  while read -r header included; do
    echo "#include \"$header\"" >>"$WORK/all.hpp"
    printf '#include "%s"\n' "$header" >"$WORK/user.cpp"
    [[ "$header" != */faust_dsp.hpp ]] || sed -i '1i #include <faust/gui/UI.h>\n#include <faust/gui/meta.h>' "$WORK/user.cpp"  # as it asks for
    precompiled=()
    [ -z "$included" ] || precompiled=(-include-pch "$WORK/${included##*/}.pch")
    run clang++ "${options[@]}" -fsyntax-only "${precompiled[@]}" "$WORK/user.cpp"
  done <"$WORK/headers"
  for compiler in g++ clang++; do
    run "$compiler" "${options[@]}" -fsyntax-only -include "$WORK/all.hpp" "$templates"
  done
  # A class that the list of templates lacks.
  for header in $(public_headers "$include"); do
    grep -qF "\"$header\"" "$templates" || ! grep -q '^class' "$include/$header" ||
      grep -qE '^class (Threads|FlushDenormals)' "$include/$header" || fail "$header is not in every_template.cpp"
  done
}

# Compilers that are too old are refused in one line, the oldest that are tested are not.
case_compilers() {
  local compiler
  for compiler in GNU/11.4 GNU/9 Clang/13.0.1; do
    ! cmake "-DCMAKE_CXX_COMPILER_ID=${compiler%/*}" "-DCMAKE_CXX_COMPILER_VERSION=${compiler#*/}" \
      -P "$SOURCE/cmake/Compiler.cmake" >"$WORK/log" 2>&1 || fail "$compiler is accepted"
    tr -s ' \n' ' ' <"$WORK/log" | grep -qF 'Contact Spline needs g++ 12 or clang++ 14, or a later one' ||
      fail "is silent about $compiler"
  done
  for compiler in GNU/12.2 Clang/14.0.6 GNU/15 Clang/22 MSVC/19.3 AppleClang/15; do
    run cmake "-DCMAKE_CXX_COMPILER_ID=${compiler%/*}" "-DCMAKE_CXX_COMPILER_VERSION=${compiler#*/}" \
      -P "$SOURCE/cmake/Compiler.cmake"
  done
}

# Builds main.cpp of the working folder with the headers of a folder, and runs it with clang's sanitizer of threads. It fails with a
# complaint where that sees a race.
run_without_races() {
  run clang++ -std=c++20 -O1 -g -fsanitize=thread "-I$1" main.cpp -o main
  if ./main >"$WORK/log" 2>&1; then return; fi
  if grep -q 'FATAL: ThreadSanitizer' "$WORK/log"; then
    echo "skipped: the sanitizer does not run on this kernel"
    exit 77
  fi
  fail "$2"
}

# Two threads may take the first powers of a process at once. Clang's sanitizer sees a race whichever thread is first.
case_quad_threads() {
  need clang++
  cd "$WORK"
  cat >main.cpp <<'END'
#include <thread>

#include "generator/support/quad.hpp"

int main() {
  using contactspline::Quad;
  Quad powers[2];
  const auto take_power = [&](int thread) { powers[thread] = exp(Quad(log(Quad(3)) + pow(Quad(1e-5), Quad(2.5)))); };
  std::thread other(take_power, 0);
  take_power(1);
  other.join();
  return powers[0] == powers[1] && powers[0] > 3 ? 0 : 1;
}
END
  run_without_races "$SOURCE" "two threads disturb each other"
}

# The audio thread and a window exchange what contacts do without a race, and what arrives is whole.
case_contact_ring() {
  need clang++
  cd "$WORK"
  cat >main.cpp <<'END'
#include <array>
#include <thread>

#include "window/contact_ring.hpp"

int main() {
  using namespace contactspline;
  constexpr std::uint32_t kBlock = 256, kBlocks = 20000, kNumbers = 1 << 22;
  static ContactRing ring;
  ring.watch(true);
  std::atomic<bool> is_done = false;
  std::thread audio([&] {
    std::array<float, kBlock> motion, force;
    for (std::uint32_t block = 0; block < kBlocks; ++block) {
      for (std::uint32_t n = 0; n < kBlock; ++n) {
        motion[n] = static_cast<float>((block * kBlock + n) % kNumbers);
        force[n] = motion[n] + 0.5f;
      }
      ring.write(motion, force, static_cast<float>(block), block);
    }
    is_done = true;
  });
  int wrong = 0;
  std::size_t read = 0;
  std::vector<ContactSample> samples;
  while (!is_done) {
    ring.read(samples);
    read += samples.size();
    for (std::size_t n = 0; n < samples.size(); ++n) {
      const ContactSample& s = samples[n];
      const bool is_whole = s.force == s.motion + 0.5f && s.energy == static_cast<float>(s.notes) &&
                            static_cast<std::uint32_t>(s.motion) / kBlock == s.notes % (kNumbers / kBlock);
      wrong += is_whole && (n == 0 || s.notes - samples[n - 1].notes <= 1) ? 0 : 1;
    }
  }
  audio.join();
  return wrong == 0 && read > 0 ? 0 : 1;
}
END
  run_without_races "$SOURCE/hosts/plugin" "audio thread and window disturb each other"
}

# Configures and builds a project of nothing but contactspline_generate(...), or another function, in the working folder.
generate_in_cmake() {
  cat >CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.25)
project(Arguments LANGUAGES NONE)
find_package(ContactSpline ${version-} CONFIG REQUIRED)
${function-contactspline_generate}($*)
END
  rm -rf build
  cmake -S . -B build -G Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix" && cmake --build build
}

# expect_refusal MESSAGE ARGUMENT...: the function called with these arguments fails and says so.
expect_refusal() {
  local message="$1"
  shift
  ! generate_in_cmake "$*" >"$WORK/log" 2>&1 || fail "accepted: $*"
  tr -s ' \n' ' ' <"$WORK/log" | grep -qF -- "$message" || fail "is silent about: $message"
}

case_arguments() {
  install_at "$WORK/prefix"
  cd "$WORK"
  cp "$SOURCE"/tests/package/project/materials/*.json .
  run generate_in_cmake TARGET t MATERIALS cork.json felt_c4 EMIT json faust cpp cpp
  [ -f build/t/cork.hpp ] && [ -f build/t/felt_c4.lib ] && [ -f build/t/felt_c4.json ] || fail "an output is missing"
  version=0.2 run generate_in_cmake TARGET t MATERIALS felt_c4
  for version in 0.1 0.3 1.2; do
    expect_refusal "compatible with requested version \"$version\"" TARGET t MATERIALS felt_c4
  done
  unset version

  local prefix='contactspline_generate: '
  expect_refusal "${prefix}TARGET: missing; needed: TARGET and MATERIALS" MATERIALS cork.json
  expect_refusal "${prefix}MATERIALS: missing; needed: TARGET and MATERIALS" TARGET t
  expect_refusal "${prefix}MATERIALS: has no value" TARGET t MATERIALS
  expect_refusal "${prefix}OUTPUT_DIR: has no value" TARGET t OUTPUT_DIR MATERIALS cork.json
  expect_refusal "${prefix}'t' is unknown; allowed: TARGET, OUTPUT_DIR, MATERIALS, EMIT" t MATERIALS cork.json
  expect_refusal "${prefix}MATERIALS: no 'OUPUT_DIR' ships; allowed: a .json file, felt_c2, felt_c4" \
    TARGET t MATERIALS cork.json OUPUT_DIR folder
  expect_refusal "${prefix}EMIT: 'rust' is unknown; allowed: cpp, faust, json" TARGET t MATERIALS cork.json EMIT rust
  expect_refusal "absent.json is not a file; allowed: material files" TARGET t MATERIALS absent.json
  cp cork.json twin.json
  expect_refusal "${prefix}MATERIALS: 'cork' is the name of two materials" TARGET t MATERIALS cork.json twin.json

  echo '{ "nme": "cork" }' >nameless.json
  expect_refusal "nameless.json: name: " TARGET t MATERIALS nameless.json
  echo '{ "name": "../cork" }' >roaming.json
  expect_refusal "roaming.json: name: '../cork' is not usable" TARGET t MATERIALS roaming.json
  echo 'cork' >words.json
  expect_refusal "words.json: name: " TARGET t MATERIALS words.json
  sed 's/"exponent": 2.0/"exponent": -2.0/' cork.json >impossible.json
  expect_refusal "impossible.json: contact.exponent: -2 is out of range" TARGET t MATERIALS impossible.json
  [ ! -e build/t/cork.hpp ] || fail "a material that was refused left a header"

  cp "$SOURCE/tests/package/project/ball.dsp" .
  cp ball.dsp 2balls.dsp
  local function
  for function in contactspline_lv2 contactspline_jack; do
    prefix="$function: "
    expect_refusal "${prefix}DSP: missing; needed: DSP" TARGET t
    expect_refusal "absent.dsp is not there; allowed: a Faust program (.dsp) or a class in C++ (.cpp)" TARGET t DSP absent.dsp
    expect_refusal "cork.json is not there; allowed: a Faust program (.dsp) or a class in C++ (.cpp)" TARGET t DSP cork.json
    expect_refusal "${prefix}VOICES: 'many' is not usable; allowed: a whole number, 0 or more" \
      TARGET t DSP ball.dsp VOICES many
    expect_refusal "${prefix}MATERIALS: 'm' is no target of contactspline_generate" TARGET t DSP ball.dsp MATERIALS m
  done
  expect_refusal "${prefix}DSP: missing; needed: DSP or INSTRUMENT" TARGET t
  expect_refusal "${prefix}INSTRUMENT: stands beside DSP" TARGET t DSP ball.dsp INSTRUMENT snare
  expect_refusal "${prefix}INSTRUMENT: no 'snarl' ships or is emitted as cpp by MATERIALS; allowed: cello, classical_guitar, " \
    TARGET t INSTRUMENT snarl
  expect_refusal "${prefix}'URI' is unknown; allowed: TARGET, DSP, VOICES, INSTRUMENT, OUTPUT_DIR, MATERIALS" \
    TARGET t DSP ball.dsp URI urn:a:b
  function=contactspline_lv2
  expect_refusal "contactspline_lv2: 'INSTRUMENT' is unknown; allowed: TARGET, DSP, VOICES, URI, OUTPUT_DIR, MATERIALS" \
    TARGET t INSTRUMENT snare
  expect_refusal "DSP: '2balls' would name a class of C++" TARGET t DSP 2balls.dsp
  PKG_CONFIG_LIBDIR=nowhere expect_refusal "something is not installed; Debian has it as: lv2-dev" TARGET t DSP ball.dsp
}

# A Faust program on a material of the project's own, as a plug-in and as a program for JACK; the instrument of
# docs/reference/instruments.md, as that page says.
case_plugins() {
  install_at "$WORK/prefix"
  cp "$SOURCE"/tests/package/project/{ball.dsp,materials/cork.json} "$WORK"
  (cd "$WORK" && blocks_of "$SOURCE/docs/reference/instruments.md" json block && mv block1.json my_zither.json)
  readme_block cmake docs/reference/instruments.md >"$WORK/zither.cmake"
  project="$WORK"
  cat >"$WORK/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(Plugins LANGUAGES CXX)
find_package(ContactSpline CONFIG REQUIRED)
contactspline_generate(TARGET materials MATERIALS cork.json EMIT faust)
contactspline_lv2(TARGET plugin DSP ball.dsp VOICES 3 URI urn:a:ball OUTPUT_DIR lv2 MATERIALS materials)
if(WITH_JACK)
  contactspline_jack(TARGET program DSP ball.dsp MATERIALS materials FAUST_OPTIONS -double)
  include(zither.cmake)
endif()
END
  for generator in Ninja 'Unix Makefiles'; do
    build="$WORK/build by $generator"
    local bundle="$build/lv2/ball.lv2"
    configure "$generator" "-DCMAKE_PREFIX_PATH=$WORK/prefix"
    build
    for file in manifest.ttl ball.ttl ball.so; do [ -f "$bundle/$file" ] || fail "no $file"; done
    grep -q '<urn:a:ball>' "$bundle/manifest.ttl" || fail "the manifest does not know the plug-in's URI"
    grep -q 'lv2:maximum 3 ' "$bundle/ball.ttl" || fail "the plug-in has another number of voices"
    expect_current

    sed -i 's/2e7/8e7/' "$WORK/cork.json"
    cp "$bundle/ball.so" "$WORK/before.so"
    build
    ! cmp -s "$bundle/ball.so" "$WORK/before.so" || fail "a changed material leaves the plug-in as it was"
    rm "$bundle/ball.ttl"
    build
    [ -s "$bundle/ball.ttl" ] || fail "a description that was removed is not made again"
    expect_current
    cp "$SOURCE/tests/package/project/materials/cork.json" "$WORK"
  done
  configure "$generator" -DWITH_JACK=ON
  build
  [ -x "$build/ball" ] || fail "no program"
  [ -x "$build/my_zither" ] || fail "no program of an instrument"
  grep -q '"hammer_speed_m_per_s"' "$build/lv2/my_zither.lv2/my_zither.ttl" || fail "the instrument's plug-in has no speed"
}

# The plug-ins alone, out of the whole. All names begin with contactspline: nobody else's are overwritten.
case_plugins_install() {
  run cmake --install "$BUILD" --component plugins --prefix "$WORK/prefix"
  local file
  for file in lib/clap/contactspline_{piano,hammer_string}.clap lib/vst3/contactspline_{piano,hammer_string}.vst3 \
    lib/lv2/contactspline_{piano,hammer_string,lap_steel,faust_piano}.lv2/manifest.ttl \
    bin/contactspline-{piano,hammer_string}; do
    [ -s "$WORK/prefix/$file" ] || fail "no $file"
  done
  [ "$(echo "$WORK"/prefix/lib/vst3/*/Contents/*-linux/*.so | wc -w)" = 5 ] || fail "a VST3 plug-in has no binary"
  [ "$(cd "$WORK/prefix" && echo * lib/*)" = "bin lib lib/clap lib/lv2 lib/vst3" ] || fail "not the plug-ins alone"
  [ ! -e "$WORK/prefix/bin/contactspline" ] || fail "not the plug-ins alone"
  [ ! -e "$WORK/prefix/lib/lv2/contactspline_faust_mass_barrier.lv2" ] || fail "a plug-in that no note plays"
  ! (cd "$WORK/prefix" && ls bin lib/*) | grep -vE '^$|:$|^contactspline[-_]' || fail "a name that others may have"
}

# scripts/plugins with the plug-ins of the build tree: what others have installed is kept, --remove removes the rest.
case_plugins_script() {
  export HOME="$WORK/home"
  mkdir -p "$WORK/tree/scripts" "$WORK/bin" "$HOME"/.lv2/{piano,contactspline_piano}.lv2
  echo foreign | tee "$HOME"/.lv2/{piano,contactspline_piano}.lv2/manifest.ttl >"$HOME/.lv2/note"
  cp "$SOURCE/scripts/plugins" "$WORK/tree/scripts"
  printf '#!/bin/sh\n' >"$WORK/tree/scripts/install-packages"
  printf '#!/bin/sh\n[ "$1" = --install ] || exit 0\nexec "%s" --install "%s" --component plugins --prefix "$6"\n' \
    "$(command -v cmake)" "$BUILD" >"$WORK/bin/cmake"
  chmod +x "$WORK/bin/cmake" "$WORK/tree/scripts/install-packages"
  mkdir -p "$WORK/tree/build/plugins"
  (cd "$HOME" && find . | sort) >"$WORK/before"
  local round script="$WORK/tree/scripts/plugins"
  for round in 1 2; do  # the second time over the first one
    PATH="$WORK/bin:$PATH" run "$script"
    grep -q 'contactspline_piano.lv2 is there already' "$WORK/log" || fail "says nothing of a foreign plug-in"
    [ -s "$HOME/.clap/contactspline_piano.clap" ] && [ -s "$HOME/.lv2/contactspline_faust_piano.lv2/manifest.ttl" ] &&
      [ -x "$HOME/.local/bin/contactspline-piano" ] || fail "not installed"
  done
  grep -qx foreign "$HOME/.lv2/contactspline_piano.lv2/manifest.ttl" || fail "a foreign plug-in was overwritten"
  run "$script" --remove
  (cd "$HOME" && find . ! -type d | sort) >"$WORK/after"
  grep -vxFf "$WORK/before" "$WORK/after" >"$WORK/log" && fail "was not removed" || true
  [ "$(wc -l <"$WORK/after")" = 3 ] || fail "a foreign file was removed"
  ! "$script" --remove >"$WORK/log" 2>&1 || fail "removes twice"
  grep -q 'no plug-ins are installed' "$WORK/log" || fail "is silent about what is not installed"

  PATH="$WORK/bin:$PATH" run "$script" "$WORK/my-prefix"
  [ -s "$WORK/my-prefix/lib/vst3/contactspline_piano.vst3/Contents/"*-linux/contactspline_piano.so ] || fail "not in PREFIX"
  run "$script" --remove "$WORK/my-prefix"
  [ -z "$(find "$WORK/my-prefix" ! -type d)" ] || fail "PREFIX keeps something"
}

# expect_settings FOLDER NAME=VALUE...: what a build folder of the scripts is set to.
expect_settings() {
  local folder="$1" setting
  shift
  for setting in "$@"; do
    grep -q "^CONTACTSPLINE_BUILD_${setting%=*}:[A-Z]*=${setting#*=}$" "$tree/build/$folder/CMakeCache.txt" ||
      fail "build/$folder is not set to $setting"
  done
}

# Calls a script of the tree, which ends where it would build.
until_build() {
  ! PATH="$WORK/bin:$PATH" "$tree/scripts/$1" "${@:2}" >"$WORK/log" 2>&1 || fail "scripts/$1 does not build"
  grep -q '^building ' "$WORK/log" || fail "scripts/$1 ends before it builds"
}

# A copy of the tree without its builds, whose scripts install no packages.
copy_tree() {
  tree="$WORK/tree"
  mkdir "$tree"
  tar -C "$SOURCE" --exclude=./.git --exclude=./build --exclude=./out --exclude=".${BUILD#"$SOURCE"}" -cf - . |
    tar -C "$tree" -xf -
  printf '#!/bin/sh\necho "packages: $*"\n' | tee "$tree/scripts/install-packages" >"$tree/scripts/format"
}

# The first command of the README, with the program that is built already.
case_run() {
  copy_tree
  mkdir -p "$WORK/bin" "$tree/build/program"
  ln -s "$BUILD/generator" "$tree/build/program/generator"
  printf '#!/bin/sh\n[ "$*" != "--build --preset program" ] || exit 0\nexec "%s" "$@" -B "%s"\n' "$(command -v cmake)" \
    "$WORK/configured" >"$WORK/bin/cmake"
  chmod +x "$WORK/bin/cmake"
  PATH="$WORK/bin:$PATH" "$tree/scripts/run" >"$WORK/log" 2>&1 || fail "scripts/run fails"
  for sound in fur_elise steel_phrase; do
    [ -s "$tree/out/$sound.wav" ] && [ -s "$tree/out/$sound.svg" ] || fail "scripts/run does not play $sound"
  done
  ! grep -qi 'warning' "$WORK/log" || fail "scripts/run warns"
}

# The scripts one after the other: none undoes what another has set. With a cmake that configures, but builds nothing.
case_scripts() {
  copy_tree
  mkdir "$WORK/bin"
  printf '#!/bin/sh\n[ "$1" != --build ] || { echo "building $*"; exit 9; }\nexec "%s" "$@"\n' "$(command -v cmake)" \
    >"$WORK/bin/cmake"
  chmod +x "$WORK/bin/cmake"

  until_build run
  expect_settings program TESTS=OFF
  ! grep -q 'CMake Warning' "$WORK/log" || fail "scripts/run warns"
  [ ! -e "$tree/build/release" ] || fail "scripts/run configures build/release"
  until_build test
  grep -qx 'packages: test' "$WORK/log" || fail "scripts/test installs other packages"
  expect_settings test TESTS=ON PLUGINS=OFF PYTHON=OFF
  [ ! -e "$tree/build/release" ] || fail "scripts/test configures build/release"
  until_build test --all
  grep -qx 'packages: ci' "$WORK/log" || fail "scripts/test --all installs other packages"
  expect_settings release TESTS=ON PLUGINS=ON HOSTS=ON PYTHON=ON
  expect_settings program TESTS=OFF
  expect_settings test PLUGINS=OFF
  until_build plugins
  grep -qx 'packages: plugins' "$WORK/log" || fail "scripts/plugins installs other packages"
  expect_settings plugins PLUGINS=ON TESTS=OFF GENERATOR=OFF EXAMPLES=OFF
  expect_settings release TESTS=ON PLUGINS=ON
  until_build run
  expect_settings plugins PLUGINS=ON
  ! grep -qF -e "$tree/generator/" -e "$tree/tests/" "$tree/build/plugins/build.ninja" || fail "scripts/plugins builds more than plug-ins"

  ! "$tree/scripts/plugins" --help >"$WORK/log" 2>&1 || fail "scripts/plugins accepts an option"
  grep -q '^usage: scripts/plugins' "$WORK/log" || fail "scripts/plugins does not say how to use it"
  ! cmake --preset plugins -S "$tree" -B "$WORK/without" \
    '-DCMAKE_IGNORE_PATH=/usr/share/dpf;/usr/local/share/dpf' >"$WORK/log" 2>&1 || fail "builds without the framework"
  tr -s ' \n' ' ' <"$WORK/log" | grep -qF 'Debian has it as: dpf-source' || fail "is silent about the framework"
}

case_pkg_config() {
  need pkg-config
  install_at "$WORK/prefix"
  export PKG_CONFIG_PATH="$WORK/prefix/share/pkgconfig"
  local project="$SOURCE/tests/package/project"
  run "$WORK/prefix/bin/contactspline" generate "$project"/materials/{cork,drop}.json --emit cpp -o "$WORK/generated"
  # shellcheck disable=SC2046  # words are what is wanted
  run "$CXX" -std=c++20 -O2 $(pkg-config --cflags contactspline) -I"$WORK/generated" "$project/main.cpp" \
    -o "$WORK/consumer"
  build="$WORK" expect_right_durations
}

# Compiles a Faust program against the installed folder and prints samples of it with "throw" pressed.
faust_samples() {
  run faust -I "$(pkg-config --variable=faustdir contactspline)" -I "$WORK" -a plot.cpp "$1" -o "$WORK/plot.cpp"
  run "$CXX" -w -O2 "$WORK/plot.cpp" -o "$WORK/plot"
  "$WORK/plot" -throw 1 -n 400
}

case_faust() {
  need faust
  need pkg-config
  install_at "$WORK/prefix"
  export PKG_CONFIG_PATH="$WORK/prefix/share/pkgconfig"
  local project="$SOURCE/tests/package/project"
  run "$WORK/prefix/bin/contactspline" generate "$project/materials/cork.json" --emit faust -o "$WORK"
  faust_samples "$project/ball.dsp" >"$WORK/samples"
  expect_peak_force 1 2e7 2.0 0.004 2 <"$WORK/samples"
  expect_peak_force 2 4.5e9 2.5 0.004 2 <"$WORK/samples"
  faust_samples "$WORK/prefix/share/contactspline/faust/mass_barrier.dsp" >"$WORK/samples"
  expect_peak_force 2 4.5e9 2.5 0.00297 2 <"$WORK/samples"

  # Instruments without what others have: springs, controls, contacts. Nothing acts on their idle body.
  local bodies='"bodies": [{ "name": "ball", "mass_kg": 0.01 }, { "name": "bar", "resonator": "marimba_c4" },
      { "name": "idle", "modes": [{ "frequency_hz": 100, "decay_per_s": 1, "mass_kg": 1 }] }],
    "places": [{ "name": "middle", "body": "bar", "position_m": 0.1 }],
    "outputs": [{ "name": "bar", "velocity_m_per_s": "middle" }]'
  local contact='"contacts": [{ "name": "hit", "between": ["ball", "middle"], "material": "felt_c4" }]'
  local spring='"springs": [{ "name": "coil", "between": ["ball", "middle"], "stiffness_n_per_m": 100 }]'
  local control='"controls": [{ "name": "hand", "damping_per_s": ["bar", "idle"] }]' part n=0
  for part in "$contact" "$spring" "$contact, $control" "$contact, $spring" "$control"; do
    n=$((n + 1))
    echo "{ \"name\": \"probe_$n\", $bodies, $part }" >"$WORK/probe_$n.json"
    run "$WORK/prefix/bin/contactspline" generate "$WORK/probe_$n.json" --emit faust -o "$WORK"
    run faust -I "$WORK/prefix/share/contactspline/faust" "$WORK/probe_$n.lib" -o "$WORK/probe.cpp"
  done
}

# The folder of examples as a project of its own.
case_examples() {
  install_at "$WORK/prefix"
  cp -r "$SOURCE/examples" "$WORK/examples"
  project="$WORK/examples" build="$WORK/build"
  configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix"
  build
  run "$build/piano_phrase" "$WORK/phrase.wav"
  [ "$(stat -c %s "$WORK/phrase.wav")" -gt 800000 ] || fail "the phrase is short"
  run "$build/gradients"
}

# The examples that are plug-ins.
case_examples_plugins() {
  install_at "$WORK/prefix"
  cp -r "$SOURCE/examples" "$WORK/examples"
  project="$WORK/examples" build="$WORK/build"
  configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix" -DCONTACTSPLINE_BUILD_PLUGINS=ON
  run cmake --build "$build" --target my_hammer_string_clap
  run "$BUILD/tests/plugins/play_plugin" clap "$build/clap/my_hammer_string.clap"
}

# The instrument file of docs/reference/instruments.md and a class of one's own become CLAP, VST3 and LV2 by a line each, and sound.
case_own_plugin() {
  install_at "$WORK/prefix"
  (cd "$WORK" && blocks_of "$SOURCE/docs/reference/instruments.md" json block && mv block1.json my_zither.json)
  # With a licence, keys, presets and a place that moves; then it plays a MIDI file: C4 and G4, half a second each.
  sed -i -e '0,/"name": "my_zither",/s//"name": "my_zither", "license": "CC-BY-4.0",/' \
    -e 's/"controls": \[/"controls": [ { "name": "hammer", "place_m": "struck", "max": 0.5 },/' \
    -e 's/"strikes":/"keys": [ { "first": 48, "last": 72, "event": "strike_hammer", "tuned_key": 60 } ],\n  &/' \
    -e 's/"outputs":/"presets": [ { "name": "middle", "hammer_place_m": 0.3 } ],\n  &/' "$WORK/my_zither.json"
  printf 'MThd\0\0\0\6\0\0\0\1\0\140MTrk\0\0\0\24\0\220\074\144\140\200\074\0\0\220\103\144\140\200\103\0\0\377\057\0' >"$WORK/song.mid"
  (cd "$WORK" && run "$WORK/prefix/bin/contactspline" render song.mid --instrument my_zither.json -o song.wav)
  [ -s "$WORK/song.wav" ] || fail "no sound of the MIDI file"
  # The class of docs/how-to/model.md, without its program.
  (cd "$WORK" && blocks_of "$SOURCE/docs/how-to/model.md" cpp bell && sed '/^int main/,$d' bell1.cpp >my_bell.hpp)
  (cd "$WORK" && blocks_of "$SOURCE/docs/how-to/model.md" json score && mv score1.json bell_score.json)
  cat >"$WORK/my_bell_dsp.cpp" <<'END'
#include "my_bell.hpp"
#include "contactspline/host/faust_dsp.hpp"

class my_bell_dsp : public contactspline::InstrumentDsp<Bell> {
 public:
  my_bell_dsp() : InstrumentDsp("my_bell_dsp") {}
};
END
  # The project of that page, and more.
  (cd "$WORK" && blocks_of "$SOURCE/docs/how-to/model.md" cmake project && mv project1.cmake CMakeLists.txt)
  cat >>"$WORK/CMakeLists.txt" <<'END'
find_package(GTest REQUIRED)
contactspline_generate(TARGET my_instruments MATERIALS my_zither.json)
contactspline_plugin(TARGET my_zither INSTRUMENT my_zither MATERIALS my_instruments VENDOR Me URI urn:me:my_zither)
contactspline_plugin(TARGET my_chime HEADER my_bell.hpp CLASS Bell FORMATS clap)
contactspline_lv2(TARGET my_bell_dsp DSP my_bell_dsp.cpp URI urn:me:my_bell_dsp OUTPUT_DIR lv2)

# The tests of all instruments that ship, over this class.
add_executable(my_bell_test ${TESTS}/instrument/every_instrument_test.cpp ${TESTS}/support/count_allocations.cpp)
target_include_directories(my_bell_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${TESTS} ${TESTS}/..)
target_link_libraries(my_bell_test PRIVATE ContactSpline::materials GTest::gtest_main)
target_compile_definitions(my_bell_test PRIVATE CONTACTSPLINE_LIST="my_list.hpp")
END
  cat >"$WORK/my_list.hpp" <<'END'
#include <gtest/gtest.h>
#include "contactspline/host/any_instrument.hpp"
#include "my_bell.hpp"
namespace contactspline::testing {
using Precisions = ::testing::Types<Bell::value_type>;
template <typename T>
constexpr std::array<Handle<T> (*)(), 1> kInstruments{handle_of<Bell>};
}  // namespace contactspline::testing
END
  project="$WORK" build="$WORK/build"
  # -O1 compiles faster, and what is played here is short.
  configure Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" "-DCMAKE_PREFIX_PATH=$WORK/prefix" \
    "-DTESTS=$SOURCE/tests"
  build
  run "$build/my_bell_test"
  local play="$BUILD/tests/plugins/play_plugin" ttl="$build/lv2/my_zither.lv2/my_zither.ttl"
  run "$play" clap "$build/clap/my_zither.clap"
  run "$play" vst3 "$build"/vst3/my_zither.vst3/Contents/*-linux/my_zither.so
  LV2_PATH="$build/lv2" run "$play" lv2 urn:me:my_zither
  run "$play" clap "$build/clap/my_bell.clap"
  run "$play" vst3 "$build"/vst3/my_bell.vst3/Contents/*-linux/my_bell.so
  LV2_PATH="$build/lv2" run "$play" lv2 urn:me:my_bell
  (cd "$WORK" && run "$WORK/prefix/bin/contactspline" render bell_score.json --instrument build/bell.so -o bell.wav)
  grep -q '^2 contacts in 2 s' "$WORK/log" || fail "a score does not strike the bell twice: $(cat "$WORK/log")"
  local plugin
  plugin=$build/lv2/my_bell.lv2/my_bell.so
  ! "$WORK/prefix/bin/contactspline" render "$WORK/bell_score.json" --instrument "$plugin" -o "$WORK/x.wav" 2>"$WORK/log" ||
    fail "a plug-in is taken for a model"
  grep -q -- '--instrument: is a library of something else; allowed: a library of contactspline_model()' "$WORK/log" ||
    fail "says something else of a plug-in: $(cat "$WORK/log")"
  (cd "$WORK" && run "$WORK/prefix/bin/contactspline" render song.mid --instrument build/bell.so -o bell_song.wav)
  grep -q '^2 contacts in' "$WORK/log" || fail "a MIDI file does not strike the bell twice: $(cat "$WORK/log")"
  [ -s "$build/lv2/my_bell_dsp.lv2/my_bell_dsp.ttl" ] || fail "no plug-in of the class as Faust's dsp"
  [ -e "$build/clap/my_chime.clap" ] || fail "no plug-in in the one format that was asked for"
  [ ! -e "$build/vst3/my_chime.vst3" ] || fail "a format that was not asked for"
  local text
  for text in '"a string that buzzes on a wire"' '"CC-BY-4.0"' 'doap:name "my zither"' 'foaf:name "Me"'; do
    grep -qF "$text" "$ttl" || fail "the description of the plug-in lacks $text"
  done
  expect_current

  # The same without a word of CMake, by the installed program.
  (cd "$WORK" && run "$WORK/prefix/bin/contactspline" plugin my_zither.json -o "my plug-ins" --vendor Me)
  local made="$WORK/my plug-ins"
  run "$play" clap "$made/clap/my_zither.clap"
  run "$play" vst3 "$made"/vst3/my_zither.vst3/Contents/*-linux/my_zither.so
  LV2_PATH="$made/lv2" run "$play" lv2 urn:contactspline:own:my_zither
  grep -qF 'foaf:name "Me"' "$made/lv2/my_zither.lv2/my_zither.ttl" || fail "the plug-in has another maker"
  local sources="$WORK/prefix/share/contactspline/plugin"
  mv "$sources" "$sources.away"
  (cd "$WORK" && ! "$WORK/prefix/bin/contactspline" plugin my_zither.json -o broken 2>"$WORK/log") ||
    fail "a plug-in of a damaged package"
  [ "$(wc -l <"$WORK/log")" = 1 ] && grep -q '^contactspline: broken/build/build.log: build: ' "$WORK/log" ||
    fail "no clear line where the project cannot be built"
  mv "$sources.away" "$sources"

  cd "$WORK"
  local function=contactspline_plugin prefix='contactspline_plugin: '
  expect_refusal "${prefix}INSTRUMENT: missing; needed: INSTRUMENT, or HEADER with CLASS" TARGET t
  expect_refusal "${prefix}INSTRUMENT: stands beside HEADER or CLASS" TARGET t INSTRUMENT piano CLASS C
  expect_refusal "${prefix}INSTRUMENT: no 'snarl' ships or is emitted as cpp by MATERIALS; allowed: cello, classical_guitar, " \
    TARGET t INSTRUMENT snarl
  expect_refusal "${prefix}TARGET: 'a.b' is not usable" TARGET a.b INSTRUMENT piano
  expect_refusal "${prefix}FORMATS: 'vst2' is unknown; allowed: clap, vst3, lv2" TARGET t INSTRUMENT piano FORMATS vst2
  expect_refusal "${prefix}MATERIALS: 'm' is no target" TARGET t INSTRUMENT piano MATERIALS m
  expect_refusal "${prefix}ID: 'a b' is not usable" TARGET t INSTRUMENT piano ID '"a b"'
  expect_refusal "${prefix}URI: 'my_piano' is no URI" TARGET t INSTRUMENT piano URI my_piano
}

# expect_object FILE CODE DATA SYMBOLS: an object for a microcontroller is at most that large, in bytes, and needs no other
# symbols.
expect_object() {
  local symbols
  symbols=$(arm-none-eabi-nm -u "$1" | awk -v known="^($4)\$" '$2 !~ known { print $2 }')
  [ -z "$symbols" ] || fail "$1 also needs $symbols"
  arm-none-eabi-size "$1" | awk -v code="$2" -v data="$3" '
    NR == 2 { print $6 ": " $1 " bytes of code, " $2 + $3 " of data"; exit !($1 > 1000 && $1 <= code && $2 + $3 <= data) }' ||
    fail "$1 is larger than docs/how-to/microcontrollers.md says"
}

# docs/how-to/microcontrollers.md, word for word, and the figures that it states.
case_microcontroller() {
  need arm-none-eabi-g++
  need faust
  cd "$WORK"
  readme_block cpp docs/how-to/microcontrollers.md >model.cpp
  readme_block c docs/how-to/microcontrollers.md >main.c
  ln -s "$SOURCE/runtime" "$SOURCE/faust" "$SOURCE/generated" .
  mkdir build
  ln -s "$BUILD" build/program
  run bash -ec "$(readme_block sh docs/how-to/microcontrollers.md)"
  ! grep -E ':[0-9]+:[0-9]+: (warning|error)' "$WORK/log" || fail "the page is compiled with warnings"
  expect_object model.o 12288 6144 'memcpy|memset'
  for program in slide_string fret_string; do
    expect_object $program.o 102400 2048 'calloc|free|sinf|cosf|expf|logf|memcpy|memset'
    expect_object $program.elf 112640 8192 ''
  done
}

# Commands of the pages that case_pages does not run, and why.
not_run='
^(\./)?scripts/(run|test|plugins|windows|web|site|tidy|format|bench|sanitize|exhaustive|fuzz|mutate|matrix|soak|coverage|bare-root|packages|faust-patch|faust-functions)    builds the whole tree, or changes the source
^(\./)?scripts/install-packages                asks the network
^(\./)?scripts/leaks                           two minutes under valgrind
^cmake --(preset|build)                        builds the whole tree
^cmake (-S examples|--install build )           in case_examples_plugins
^cmake --install build/hosts                     in case_hosts
^cmake -B build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=      in case_own_plugin
^contactspline render bell_score.json --instrument build/bell.so     in case_own_plugin
^cmake --install build/c |^cc -std=c99|^  -Wl,-rpath|^./first     in case_c
^g\+\+ .*contactspline-simd                    in case_kernels
^cp index.html node_modules/contactspline         web.package does the same
^cp examples/fit/kalimba|kalimba_song\.json|my_kalimba\.json    in fit_doc_test: the fit takes a minute
^contactspline plugin tom                      half a minute, as the tutorial takes for its instrument
arm-none-eabi|^for program|^  (read|echo|faust)|^ +(process|main\.c|-idirafter|-fno)|^done$   in case_microcontroller
'

# The commands of a page in order: its sh blocks, and the indented lines that begin with a command.
commands_of() {
  awk '/^```/ { on = !on; sh = on && $0 == "```sh"; next }
       sh { print }
       !on && /^    (contactspline|cmake|cp (-r )?[a-z]|mkdir|build\/|(\.\/)?scripts\/)/ { sub(/^    /, ""); print }' "$1" |
    grep -vE "$(awk 'NF { sub(/   .*/, ""); print }' <<<"$not_run" | paste -sd '|')" || true
}

# Leaves commands out that do the same on each page and ran on an earlier one: `list`, and scores that ship, with -o and without.
fresh_commands() {
  local command key
  while IFS= read -r command; do
    key=$(sed 's/ *#.*//; s/ -o [^ ]*/ -o/; s|^build/program/generator/||' <<<"$command")
    if [[ "$key" =~ ^contactspline\ (list|render\ [a-z_]+(\ -o)?$) ]]; then
      ! grep -qxF -- "$key" "$WORK/commands that ran" || continue
      echo "$key" >>"$WORK/commands that ran"
    fi
    printf '%s\n' "$command"
  done
}

# Writes each block of a language in a page into a file of its own: blocks_of PAGE LANGUAGE PREFIX.
blocks_of() {
  awk -v fence="\`\`\`$2" -v prefix="$3" '/^```/ { on = $0 == fence; count += on; next }
    on { print > prefix count "." substr(fence, 4) }' "$1"
}

# The files that the commands of a page name: its materials and resonators, its curves, its scores, its project.
files_of() {
  blocks_of "$1" json block
  blocks_of "$1" csv curve
  [[ "$1" != */tuning.md ]] || { blocks_of "$1" text scale && mv scale1.text just.scl; }
  local block name
  for block in block*.json; do
    [ -e "$block" ] || continue
    name=$(sed -nE 's/^  "name": "([a-z_0-9]+)".*/\1/p; s/^  "instrument": "(examples\/keyboards\/)?(piano|phantom_bass)(\.json)?".*/my_\2_score/p; s/^  "instrument": "([a-z_]+)\.json".*/\1_score/p' "$block" | head -n 1)
    [ -z "$name" ] || mv "$block" "$name.json"
  done
  [ ! -e curve2.csv ] || { mv curve1.csv my_felt.csv && mv curve2.csv my_impact.csv; }
  cp "$SOURCE/data/scores/bach_prelude.mid" my_song.mid
  readme_block cmake "${1#"$SOURCE/"}" >CMakeLists.txt
}

# Every page word for word, in a folder of its own: its commands, its programs in C++ and in Faust. The cases readme,
# kernels, polyphony and microcontroller compile those pages; materials_doc_test and shipped_score_test read every JSON.
case_pages() {
  need faust
  install_at "$WORK/prefix"
  export PATH="$WORK/prefix/bin:$PATH"
  local page name block plugin commands=0 programs=0
  : >"$WORK/commands that ran"
  for page in "$SOURCE"/{README,CONTRIBUTING}.md "$SOURCE"/docs/*/*.md; do
    mkdir -p "$WORK/${page#"$SOURCE/"}/build"
    cd "$WORK/${page#"$SOURCE/"}"
    for name in program release test; do ln -s "$BUILD" "build/$name"; done
    name=$(basename "$page" .md)
    [[ $name != @(fit|instruments|keyboard|longitudinal) ]] || ln -s "$SOURCE/examples" examples
    files_of "$page"
    commands=$((commands + $(commands_of "$page" | wc -l)))
    commands_of "$page" | fresh_commands >commands.sh
    HOME="$PWD/home" run bash -ex commands.sh
    case "$name" in README | kernels | polyphony | microcontrollers) continue ;; esac
    blocks_of "$page" cpp program
    blocks_of "$page" faust program
    for block in program*; do
      [ -e "$block" ] || continue
      programs=$((programs + 1))
      case "$block" in
        *.faust) run faust -I "$WORK/prefix/share/contactspline/faust" "$block" -o "$block.cpp" ;;
        *) if grep -q 'int main' "$block"; then
            run "$CXX" -std=c++20 -O1 -I "$WORK/prefix/include" -I . "$block" -o "$block.program"
            run "./$block.program"
          else
            run "$CXX" -std=c++20 -fsyntax-only -I "$WORK/prefix/include" -include faust/gui/UI.h \
              -include faust/gui/meta.h "$block"
          fi ;;
      esac
    done
  done
  # The commands of the tutorial for its Faust program.
  cd "$WORK/docs/start/tutorial.md"
  printf 'process = library("code/my_instrument.lib").instrument;\n' >my_program.dsp
  PKG_CONFIG_PATH="$WORK/prefix/share/pkgconfig" bash -e <(sed -nE 's/^    ((faust|g\+\+|\.\/my_program) .*)/\1/p' \
    "$SOURCE/docs/start/tutorial.md") >samples 2>"$WORK/log" || fail "a command of the tutorial fails: $(cat "$WORK/log")"
  awk '$1 != 0 { moves = 1 } END { exit NR != 300 || !moves }' samples || fail "the tutorial's program prints zeros"
  for plugin in clap/my_instrument.clap vst3/my_instrument.vst3/Contents lv2/my_instrument.lv2/my_instrument.so; do
    [ -e "$WORK/docs/start/tutorial.md/home/.$plugin" ] || fail "the tutorial ends without $plugin"
  done
  echo "$commands commands, $programs programs"
  [ "$commands" -ge 30 ] && [ "$programs" -ge 13 ] || fail "only $commands commands and $programs programs were found"
}

# Csound and Pd find what is installed in ~/.local by themselves.
case_hosts() {
  mkdir -p "$WORK/home"
  install_at "$WORK/home/.local"
  export HOME="$WORK/home"
  cd "$WORK"
  if [ -e "$HOME/.local/lib/csound" ] && command -v csound >/dev/null; then
    blocks_of "$SOURCE/docs/how-to/csound.md" csound first
    run csound first1.csound
    [ "$(wc -c <first.wav)" -gt 700000 ] || fail "csound wrote no first.wav of 2 s"
    cd "$HOME/.local/share/contactspline/examples/csound"
    run csound drone.csd -o "$WORK/drone.wav"
    [ "$(wc -c <"$WORK/drone.wav")" -gt 6000000 ] || fail "csound wrote no drone.wav of 16 s"
    cd "$WORK"
  fi
  if [ -e "$HOME/.local/lib/pd" ] && command -v pd >/dev/null; then
    printf '%s\n' '#N canvas 0 0 450 300 10;' '#X obj 9 9 contactspline~ piano;' '#X msg 9 9 print;' '#X obj 9 9 loadbang;' \
      '#X msg 9 9 \; pd quit;' '#X connect 1 0 0 0;' '#X connect 2 0 1 0;' '#X connect 2 0 3 0;' >first.pd
    run pd -batch -nogui -noaudio -stderr first.pd
    grep -q 'parameter bend_cents: -200 to 200 cents' "$WORK/log" || fail "pd did not find contactspline~"
  fi
}

# The site of the docs: complete, and without a request to elsewhere.
case_site() {
  need mkdocs
  run "$SOURCE/scripts/site" --build
  local site="$SOURCE/build/site" page
  for page in "$SOURCE"/docs/*/*.md; do
    page=${page#"$SOURCE/"}
    [ -s "$site/${page%.md}.html" ] || fail "no page of $page"
  done
  grep -q '"title": "The contact step"' "$site/sections.js" || fail "the search does not know the contact step"
  ! grep -rEo '(<(script|link|img|iframe|audio)[^>]*|@import[^;]*|url\()["'\'']?https?:[^ >]*' "$site" --include=*.html --include=*.css ||
    fail "the site requests something from elsewhere"
}

# The README's examples, word for word.
case_readme() {
  install_at "$WORK/prefix"
  project="$WORK/project" build="$WORK/build"
  mkdir "$project"
  readme_program >"$project/main.cpp"
  readme_block json >"$project/my_felt.json"
  { echo 'cmake_minimum_required(VERSION 3.25)
project(Readme LANGUAGES CXX)
add_executable(my_plugin main.cpp)'
    readme_block cmake; } >"$project/CMakeLists.txt"
  configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix"
  build
  [ -f "$build/my_materials/my_felt.hpp" ] && [ -f "$build/my_materials/my_felt.lib" ] || fail "an output is missing"
  "$build/my_plugin" | expect_peak_force 3 4.5e9 2.5 0.003 2
  run "$CXX" -std=c++20 -O2 -I "$SOURCE/runtime" -I "$BUILD/include" "$project/main.cpp" -o "$WORK/hammer"
  "$WORK/hammer" | expect_peak_force 3 4.5e9 2.5 0.003 2
  { readme_block cpp | sed '/mass_barrier/,$d'
    echo 'int main() { float l[4800], r[4800], peak = 0; key(60, 0.7f); block(l, r); for (float x : l) peak = x > peak ? x : peak; return !(peak > 1e-4f && peak < 1); }'; } >"$WORK/piano.cpp"
  run "$CXX" -std=c++20 -O1 -I "$SOURCE/runtime" -I "$BUILD/include" "$WORK/piano.cpp" -o "$WORK/piano"
  run "$WORK/piano"

  command -v faust >/dev/null || return 0
  export PKG_CONFIG_PATH="$WORK/prefix/share/pkgconfig"
  readme_block faust >"$WORK/readme.dsp"
  faust_samples "$WORK/readme.dsp" >"$WORK/samples"
  expect_peak_force 2 4.5e9 2.5 0.003 2 <"$WORK/samples"

  # Its own commands, in the source tree.
  mkdir "$WORK/tree"
  ln -s "$SOURCE/faust" "$SOURCE/generated" "$WORK/tree"
  cp "$WORK/readme.dsp" "$WORK/tree/throw.dsp"
  sed -nE 's/^    ((faust|g\+\+|\.\/throw) .*)/\1/p' "$SOURCE/README.md" >"$WORK/tree/commands"
  (cd "$WORK/tree" && bash -e commands 2>&1) >"$WORK/samples" || fail "a command of the README fails: $(cat "$WORK/samples")"
  expect_peak_force 2 4.5e9 2.5 0.003 2 <"$WORK/samples"
}

# The examples of docs/how-to/polyphony.md, on the optional libraries: one voice of 500, a third of the way to the right, and
# three keys of an ensemble.
case_polyphony() {
  install_at "$WORK/prefix"
  project="$WORK/project" build="$WORK/build"
  mkdir "$project"
  blocks_of "$SOURCE/docs/how-to/polyphony.md" cpp "$project/program"
  cat >"$project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(Polyphony LANGUAGES CXX)
find_package(ContactSpline CONFIG REQUIRED)
add_executable(band program1.cpp)
add_executable(dulcimer program2.cpp)
foreach(program band dulcimer)
  target_link_libraries(${program} PRIVATE ContactSpline::materials ContactSpline::simd ContactSpline::threads)
endforeach()
END
  configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix" -DCMAKE_BUILD_TYPE=Release
  build
  "$build/band" | awk '
    { print; ratio = $2 / $1 / sqrt(0.3 / 0.7) }
    END { exit !(ratio > 0.9999 && ratio < 1.0001 && $3 == 1) }' || fail "the example does not play as it says"
  "$build/dulcimer" | awk '{ print } END { exit !($1 * $1 > 0 && $3 == 3) }' || fail "the keys do not play"
}

# docs/how-to/c.md word for word, on the installed library; its symbols; the program's line for a wrong file.
case_c() {
  need cc
  need pkg-config
  local page="$SOURCE/docs/how-to/c.md" prefix="$WORK/home/.local"
  mkdir "$WORK/home"
  install_at "$prefix"
  cd "$WORK"
  export PKG_CONFIG_PATH="$prefix/share/pkgconfig"
  blocks_of "$page" c block
  mv block1.c first.c
  # Without a warning in C99; the commands of the page; two seconds of two channels that sound.
  run cc -std=c99 -pedantic-errors -Wall -Wextra -Wconversion -Werror -fsyntax-only "-I$prefix/include" first.c
  blocks_of "$page" sh block
  run bash -ex block1.sh
  loudest first.raw 192000
  run cc -std=c99 -Wall -Wextra -Werror -fsyntax-only "-I$prefix/include" block2.c

  # Only functions of the interface are visible, each with a version, and contactspline_handle(), which plug-ins call.
  nm -D --defined-only "$prefix"/lib/libcontactspline.so | awk '$2 != "A" && !/contactspline_handle@/ { print $3 }' >symbols
  [ "$(wc -l <symbols)" = "$(grep -cE '^[a-z].*contactspline_[a-z_]+\(' "$SOURCE/hosts/c/contactspline.h")" ] ||
    fail "the header and the library have different functions: $(cat symbols)"
  ! grep -vE '^contactspline_[a-z_]+@@CONTACTSPLINE_[0-9.]+$' symbols || fail "other symbols are visible"

  # The program's own line, from text and from a file.
  sed 's/"mass_kg": 0.000555/"mass_kg": -1/' "$SOURCE/data/instruments/tanpura.json" >bad.json
  ! "$prefix/bin/contactspline" generate bad.json -o out 2>expected || fail "a negative mass is accepted"
  cat >create.c <<'END'
#include <contactspline.h>
#include <stdio.h>
int main(int argc, char** argv) {
  (void)argc;
  contactspline_instrument* instrument = contactspline_create(argv[1], 44100, CONTACTSPLINE_DOUBLE);
  if (!instrument) return printf("contactspline: %s\n", contactspline_last_error()), 2;
  contactspline_destroy(instrument);
  return 0;
}
END
  project="$WORK/project" build="$WORK/build"
  mkdir "$project"
  mv create.c "$project"
  echo 'cmake_minimum_required(VERSION 3.25)
project(Create LANGUAGES C)
set(CMAKE_C_STANDARD 99)
find_package(ContactSpline CONFIG REQUIRED)
add_executable(create create.c)
target_link_libraries(create PRIVATE ContactSpline::c)' >"$project/CMakeLists.txt"
  configure Ninja "-DCMAKE_PREFIX_PATH=$prefix"
  build
  ! "$build/create" bad.json >actual || fail "the library accepts a negative mass"
  diff expected actual || fail "the library says something else than the program"
  run "$build/create" tanpura
  run "$build/create" "$SOURCE/data/instruments/tanpura.json"
}

# A file of so many single-precision samples, all finite, which sounds without reaching full scale: loudest FILE COUNT.
loudest() {
  od -An -v -tf4 -w4 "$1" | awk -v count="$2" '
    { x = $1 < 0 ? -$1 : $1; if (!(x < 1)) exit bad = 1; if (x > peak) peak = x }
    END { print NR " samples, largest " peak; exit bad || NR != count || !(peak > 1e-3) }' || fail "$1 does not sound"
}

# The example of docs/how-it-works/kernels.md, with the vectorised kernels and without: the same but for rounding.
case_kernels() {
  need pkg-config
  install_at "$WORK/prefix"
  project="$WORK/project" build="$WORK/build"
  mkdir "$project"
  readme_block cpp docs/how-it-works/kernels.md >"$project/main.cpp"
  { echo 'cmake_minimum_required(VERSION 3.25)
project(Kernels LANGUAGES CXX)
find_package(ContactSpline CONFIG REQUIRED)
add_executable(my_plugin main.cpp)
add_executable(plain main.cpp)
target_link_libraries(plain PRIVATE ContactSpline::materials)'
    readme_block cmake docs/how-it-works/kernels.md; } >"$project/CMakeLists.txt"
  configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/prefix" -DCMAKE_BUILD_TYPE=Release
  build
  "$build/plain" >"$WORK/plain"
  (cd "$project" && PKG_CONFIG_PATH="$WORK/prefix/share/pkgconfig" run bash -ec "$(readme_block sh docs/how-it-works/kernels.md)")
  "$project/by_pkg_config" | cmp - <("$build/my_plugin") || fail "the kernels by pkg-config play something else"
  "$build/my_plugin" | paste - "$WORK/plain" | awk '
    function off(a, b) { return a - b > b - a ? a - b : b - a }
    { if (!(off($1, $5) <= 1e-15) || !(off($3, $7) <= 1e-9)) exit 1; if (off($1, 0) > peak) peak = off($1, 0) }
    END { print NR " blocks, largest " peak " m"; exit !(NR == 100 && peak > 1e-5 && peak < 1e-2) }' ||
    fail "the example does not play the same with and without the kernels"
}

# Each file of `cmake --install` is in one Debian package: packaging/debian/rules names a component for each package of
# packaging/debian/control, these have every file between them, and no file is in two. The licence is in debian/copyright.
case_components() {
  local debian="$SOURCE/packaging/debian" package component
  run cmake --install "$BUILD" --prefix "$WORK/all"
  run cmake --install "$BUILD" --prefix "$WORK/parts" --component licence
  sed -nE 's/^component_(.*) = (.*)/\1 \2/p' "$debian/rules" >"$WORK/components"
  diff <(sed -n 's/^Package: //p' "$debian/control" | grep -vx contactspline-doc | sort) <(cut -d' ' -f1 "$WORK/components" | sort) ||
    fail "rules and control have different packages"
  while read -r package component; do
    mkdir -p "$WORK/$component"  # what is not built has no files
    run cmake --install "$BUILD" --prefix "$WORK/$component" --component "$component"
    (cd "$WORK" && find "$component" ! -type d -printf '%P\n') >>"$WORK/files"
    [ "$component" = python ] || cp -r "$WORK/$component/." "$WORK/parts"
    [ -z "$(uniq -d <(sort "$WORK/files"))" ] || fail "$package has a file of another package: $(uniq -d <(sort "$WORK/files"))"
  done <"$WORK/components"
  diff <(cd "$WORK/all" && find . ! -type d | sort) <(cd "$WORK/parts" && find . ! -type d | sort) || fail "files are in no package"
  echo "$(wc -l <"$WORK/files") files in $(wc -l <"$WORK/components") packages"
}

# The port for vcpkg and the recipe for Conan, by the commands of CMake that these would run; then a project finds what they
# install.
case_recipes() {
  need python3
  need git
  [ -e "$SOURCE/.git" ] || { echo "skipped: the tree is no clone"; exit 77; }
  local version prefix
  version=$(sed -n 's/^version: //p' "$SOURCE/CITATION.cff")
  grep -q "\"version\": \"$version\"" "$SOURCE/packaging/vcpkg/contactspline/vcpkg.json" || fail "vcpkg.json has not the version $version"
  run cmake "-DWORK=$WORK/vcpkg" "-DPORTFILE=$SOURCE/packaging/vcpkg/contactspline/portfile.cmake" -P "$SOURCE/tests/package/recipes/vcpkg.cmake"
  run python3 "$SOURCE/tests/package/recipes/conan_run.py" "$SOURCE/packaging/conan/conanfile.py" "$WORK/conan"
  grep -qx "contactspline/$version" "$WORK/log" || fail "the recipe for Conan has not the version $version"
  project="$WORK/project"
  mkdir "$project"
  readme_program >"$project/main.cpp"
  echo 'cmake_minimum_required(VERSION 3.25)
project(Recipes LANGUAGES CXX)
find_package(ContactSpline CONFIG REQUIRED)
add_executable(my_plugin main.cpp)
target_link_libraries(my_plugin PRIVATE ContactSpline::materials)' >"$project/CMakeLists.txt"
  for prefix in vcpkg/packages conan/package; do
    build="$WORK/$prefix build"
    configure Ninja "-DCMAKE_PREFIX_PATH=$WORK/$prefix"
    build
    "$build/my_plugin" | expect_peak_force 3 4.5e9 2.5 0.003 2
  done
}

# What pip makes of the build without a network, installed where nothing else of the project is; and how it builds where nothing
# is built.
case_wheel() {
  "$PYTHON" -c 'import pip, ensurepip, numpy' 2>/dev/null || { echo "skipped: python3-pip, python3-venv or python3-numpy is not installed"; exit 77; }
  mkdir "$WORK/wheels"
  run "$PYTHON" -m pip wheel --no-index --no-build-isolation --no-deps -w "$WORK/wheels" \
    --config-settings "build-dir=$BUILD" "$SOURCE"
  run "$PYTHON" -m venv --system-site-packages "$WORK/venv"
  run "$WORK/venv/bin/pip" install --no-index --no-build-isolation "$WORK"/wheels/contactspline-*.whl
  cat >"$WORK/play.py" <<'EOF'
import pathlib, sys
import contactspline as cs

package = pathlib.Path(cs.__file__).parent
assert sys.argv[2] in str(package), package
assert (package / "py.typed").exists() and (package / "_core.pyi").exists()
string = cs.Instrument("hammer_string", resonator="string_c4", material="felt_c4")
tanpura = cs.Instrument("tanpura")
with open(sys.argv[1], "wb") as file:
    for precision in ("double", "single"):
        for sound in (string.play(cs.strike(0, 2.5), 0.5, precision=precision), tanpura.play(cs.pluck(0, 0.5), 0.1, precision=precision)):
            for samples in (*sound.outputs.values(), sound.force_n):
                assert samples.any()
                file.write(samples.tobytes())
EOF
  cd "$WORK"
  run "$WORK/venv/bin/python" play.py wheel.samples "$WORK/venv/"
  PYTHONPATH="$BUILD/python" PYTHONDONTWRITEBYTECODE=1 run "$PYTHON" play.py tree.samples "$BUILD/python/"
  cmp wheel.samples tree.samples || fail "the wheel plays other samples than the build"
  mkdir "$WORK/bin"
  printf '#!/bin/sh\n[ "$1" != --build ] || { echo "building $*"; exit 9; }\nexec "%s" "$@"\n' "$(command -v cmake)" \
    >"$WORK/bin/cmake"
  chmod +x "$WORK/bin/cmake"
  ! PATH="$WORK/bin:$PATH" "$PYTHON" -m pip wheel --no-index --no-build-isolation --no-deps -w "$WORK/wheels" \
    --config-settings "build-dir=$WORK/build" "$SOURCE" >"$WORK/log" 2>&1 || fail "no wheel is built"
  grep -q 'building .*--target contactspline_python' "$WORK/log" || fail "the wheel is not built by CMake"
  grep -q '^CONTACTSPLINE_BUILD_PYTHON:BOOL=ON$' "$WORK/build/CMakeCache.txt" || fail "the wheel's build has no Python"
  ! "$PYTHON" -m pip wheel --no-index --no-build-isolation --no-deps -w "$WORK/wheels" --config-settings nothing=1 \
    "$SOURCE" >"$WORK/log" 2>&1 || fail "an unknown setting is accepted"
  grep -q 'nothing: is unknown; allowed: build-dir' "$WORK/log" || fail "an unknown setting is not told"
}

rm -rf "$WORK"
mkdir -p "$WORK"
"case_$1"
