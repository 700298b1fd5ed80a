# contactspline_lv2(TARGET name DSP file [VOICES n] [URI uri] [OUTPUT_DIR folder] [MATERIALS target...]
#                   [FAUST_OPTIONS option...])
# contactspline_jack(TARGET name DSP file | INSTRUMENT name [VOICES n] [OUTPUT_DIR folder] [MATERIALS target...]
#                    [FAUST_OPTIONS option...])
#
# Compile a Faust program with Faust's own architecture files lv2.cpp and jack-console.cpp: contactspline_lv2 to a plug-in,
# the bundle OUTPUT_DIR/FILE.lv2; contactspline_jack to a program for the JACK server, OUTPUT_DIR/FILE, that is played by
# MIDI. FILE is the name of the Faust file without .dsp, or that of the instrument. Plug-ins of instruments are made by
# contactspline_plugin.
#
# A program with a line `effect = ...` that notes play has Faust's polyphonic effect: it processes the sum of all voices,
# and has as many inputs and outputs as a voice has outputs.
#
# DSP            the Faust program, relative to the current source folder; or a C++ file, FILE.cpp, with a class FILE that
#                has Faust's `dsp` interface, such as a HammerStringDsp of contactspline/host/faust_dsp.hpp: it goes into the
#                architecture file in place of what Faust would write
# INSTRUMENT     for contactspline_jack: the name of an instrument that ships, or of one in MATERIALS: an InstrumentDsp of
#                its class, in single precision
# VOICES         how many notes may sound at once, for programs with freq, gain and gate; 0: it is not played by notes.
#                Default: what the program says by `declare options "[nvoices:16]"`, else 0
# URI            identity of the plug-in, never to change; default: urn:contactspline:FILE
# OUTPUT_DIR     relative to the current binary folder; default: that folder
# MATERIALS      targets of contactspline_generate with EMIT faust (for a C++ file or an instrument: cpp), whose materials the
#                program uses
# FAUST_OPTIONS  for the Faust compiler, for instance -double or -vec
#
# To install a bundle: install(DIRECTORY $<TARGET_FILE_DIR:name> DESTINATION lib/lv2).

cmake_policy(VERSION 3.25)  # whatever the caller's
include(${CMAKE_CURRENT_LIST_DIR}/ContactSplineArguments.cmake)

# Finds Faust, Boost and the pkg-config packages given as pairs NAME DEBIAN_PACKAGE, imported as
# PkgConfig::CONTACTSPLINE_NAME; one line tells of all that is missing.
function(_contactspline_find)
  set(missing "")
  find_program(FAUST faust)
  find_path(FAUST_INCLUDE_DIR faust/dsp/dsp.h)
  if(NOT FAUST OR NOT FAUST_INCLUDE_DIR)
    list(APPEND missing faust)
  endif()
  find_path(CONTACTSPLINE_BOOST_INCLUDE_DIR boost/circular_buffer.hpp)  # lv2.cpp uses it
  if(NOT CONTACTSPLINE_BOOST_INCLUDE_DIR)
    list(APPEND missing libboost-dev)
  endif()
  find_package(PkgConfig QUIET)
  if(NOT PkgConfig_FOUND)
    list(APPEND missing pkg-config)
  endif()
  while(ARGN)
    list(POP_FRONT ARGN name debian)
    if(PkgConfig_FOUND)
      string(TOUPPER ${name} prefix)
      pkg_check_modules(CONTACTSPLINE_${prefix} QUIET IMPORTED_TARGET ${name})
    endif()
    if(NOT TARGET PkgConfig::CONTACTSPLINE_${prefix})
      list(APPEND missing ${debian})
    endif()
  endwhile()
  if(missing)
    list(JOIN missing " " missing)
    _contactspline_fail("something is not installed; Debian has it as: ${missing}")
  endif()
endfunction()

# Writes a C++ file with the class of the instrument arg_INSTRUMENT, as contactspline_plugin() knows it, and sets arg_DSP
# to it.
function(_contactspline_instrument_class)
  _contactspline_plugin_class()
  list(TRANSFORM header REPLACE "(.+)" "#include \"\\1\"\n")
  list(JOIN header "" includes)
  set(arg_DSP "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_class/${arg_INSTRUMENT}.cpp")
  file(CONFIGURE OUTPUT "${arg_DSP}" @ONLY CONTENT
"@includes@#include \"contactspline/host/faust_dsp.hpp\"

class @arg_INSTRUMENT@ : public contactspline::HandleDsp<float> {
 public:
  @arg_INSTRUMENT@() : HandleDsp(@handle@) {}
};
")
  return(PROPAGATE arg_DSP)
endfunction()

# Checks and completes the arguments that both functions share, and sets `stem`, the name of the Faust file, and
# `has_effect`.
function(_contactspline_faust_arguments more)
  set(one TARGET DSP VOICES ${more} OUTPUT_DIR)
  _contactspline_parse("${one}" "MATERIALS;FAUST_OPTIONS" "TARGET" ${ARGN})
  if(DEFINED arg_DSP AND DEFINED arg_INSTRUMENT)
    _contactspline_fail("INSTRUMENT: stands beside DSP; allowed: one of the two")
  elseif(NOT DEFINED arg_DSP AND NOT DEFINED arg_INSTRUMENT)
    set(sources DSP ${more})
    list(FILTER sources INCLUDE REGEX "^(DSP|INSTRUMENT)$")
    list(JOIN sources " or " sources)
    _contactspline_fail("DSP: missing; needed: ${sources}")
  endif()
  foreach(target IN LISTS arg_MATERIALS)
    get_property(is_generated TARGET ${target} PROPERTY CONTACTSPLINE_OUTPUTS SET)
    if(NOT is_generated)
      _contactspline_fail("MATERIALS: '${target}' is no target of contactspline_generate; allowed: such targets")
    endif()
  endforeach()
  if(DEFINED arg_INSTRUMENT)
    _contactspline_instrument_class()
  endif()
  cmake_path(ABSOLUTE_PATH arg_DSP BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
  cmake_path(GET arg_DSP STEM LAST_ONLY stem)
  if(NOT EXISTS "${arg_DSP}" OR NOT arg_DSP MATCHES "\\.(dsp|cpp)$")
    _contactspline_fail("DSP: ${arg_DSP} is not there; allowed: a Faust program (.dsp) or a class in C++ (.cpp)")
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${arg_DSP}")
  if(NOT DEFINED arg_VOICES)
    set(arg_VOICES 0)
    file(STRINGS "${arg_DSP}" declared REGEX "^declare options .*\\[nvoices:[0-9]+\\]")
    if(declared MATCHES "\\[nvoices:([0-9]+)\\]")
      set(arg_VOICES ${CMAKE_MATCH_1})
    endif()
  elseif(NOT arg_VOICES MATCHES "^[0-9]+$")
    _contactspline_fail("VOICES: '${arg_VOICES}' is not usable; allowed: a whole number, 0 or more")
  endif()
  _contactspline_output_dir()
  set(has_effect FALSE)
  if(arg_VOICES GREATER 0 AND arg_DSP MATCHES "\\.dsp$")
    file(STRINGS "${arg_DSP}" effects REGEX "^effect *=")
    list(LENGTH effects has_effect)
  endif()
  list(TRANSFORM one PREPEND arg_)
  return(PROPAGATE ${one} arg_MATERIALS arg_FAUST_OPTIONS stem has_effect)
endfunction()

# Checks that a class may be called as the file.
function(_contactspline_class_name)
  if(NOT stem MATCHES "^[A-Za-z_][A-Za-z0-9_]*$")
    _contactspline_fail("DSP: '${stem}' would name a class of C++; allowed: letters, digits and _, no digit first")
  endif()
endfunction()

# The build step that makes `source`, the Faust program as C++ in an architecture file; further arguments are options.
# With an effect it also makes `effect_folder`/effect.h, the effect as a class `effect`.
function(_contactspline_faust_step source architecture)
  cmake_path(GET arg_DSP PARENT_PATH program_folder)
  set(include -I "${program_folder}")
  set(depends "")
  foreach(target IN LISTS arg_MATERIALS)
    get_target_property(folder ${target} CONTACTSPLINE_OUTPUT_DIR)
    get_target_property(outputs ${target} CONTACTSPLINE_OUTPUTS)
    list(APPEND include -I "${folder}")
    list(APPEND depends ${target} ${outputs})
  endforeach()
  if(TARGET contactspline_written_libraries)  # in the tree of Contact Spline
    list(APPEND depends contactspline_written_libraries)
  endif()
  # Faust writes no dependency file: the program depends on every library it may use.
  file(GLOB libraries CONFIGURE_DEPENDS "${program_folder}/*.lib" "${ContactSpline_FAUST_DIR}/*.lib")
  set(program "${arg_DSP}")
  if(arg_DSP MATCHES "\\.cpp$")
    # Faust wants a program all the same, and throws it away. Architecture files call the class mydsp.
    set(program "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_nothing.dsp")
    file(CONFIGURE OUTPUT "${program}" CONTENT "process = 0.0;\n")
    set(class "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_class.cpp")
    file(CONFIGURE OUTPUT "${class}" @ONLY CONTENT "#include \"@arg_DSP@\"\nusing mydsp = @stem@;\n")
    list(APPEND ARGN -inj "${class}")
  endif()
  # Faust writes the name of the architecture file into the class: without its folder, it is the same wherever this is built.
  cmake_path(GET architecture PARENT_PATH architecture_folder)
  if(architecture_folder)
    cmake_path(GET architecture FILENAME architecture)
    list(APPEND ARGN -A "${architecture_folder}")
  endif()
  # -mcd 0: states in turn in two places, instead of copied after every sample (docs/measurements/faust-speed.md).
  add_custom_command(
    OUTPUT "${source}"
    COMMAND ${FAUST} -a ${architecture} -mcd 0 ${ARGN} ${arg_FAUST_OPTIONS} ${include} -I "${ContactSpline_FAUST_DIR}"
            "${program}" -o "${source}"
    DEPENDS "${FAUST}" "${arg_DSP}" ${libraries} ${depends}
    COMMENT "Compiling ${arg_TARGET} with ${architecture}"
    VERBATIM)
  if(has_effect)
    set(effect_program "${effect_folder}/effect.dsp")
    cmake_path(GET arg_DSP FILENAME program_name)
    file(CONFIGURE OUTPUT "${effect_program}" @ONLY CONTENT
"program = library(\"@program_name@\");
channels = par(i, outputs(program.process), _);
process = channels : program.effect : channels;
")
    add_custom_command(
      OUTPUT "${effect_folder}/effect.h"
      COMMAND ${FAUST} -mcd 0 -cn effect ${arg_FAUST_OPTIONS} ${include} -I "${ContactSpline_FAUST_DIR}"
              "${effect_program}" -o "${effect_folder}/effect.h"
      DEPENDS "${FAUST}" "${arg_DSP}" ${libraries} ${depends}
      COMMENT "Compiling the effect of ${arg_TARGET}"
      VERBATIM)
  endif()
endfunction()

# Sets `architecture` to a copy of Faust's lv2.cpp that passes the sum of the voices through the effect, which lv2.cpp
# does not know.
function(_contactspline_lv2_with_effect)
  execute_process(COMMAND ${FAUST} -archdir OUTPUT_VARIABLE folder OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(READ "${folder}/lv2.cpp" text)
  string(REPLACE "<<includeclass>>" "<<includeclass>>\n#include \"effect.h\"\n" text "${text}")
  string(REGEX REPLACE "(struct LV2Plugin {\n)" "\\1  effect board;\n" text "${text}")
  string(REPLACE "dsp[i]->init(rate);" "dsp[i]->init(rate); board.init(rate);" text "${text}")
  string(REGEX REPLACE "(} else {[ \t\n]*// Simple effect: We can write directly)"
    "board.compute(blocksz, outputs, outbuf);
      for (int i = 0; i < m; i++) memcpy(outputs[i], outbuf[i], blocksz*sizeof(float));
    \\1" text "${text}")
  foreach(part "<<includeclass>>\n#include" "  effect board;" "board.init" "board.compute")
    string(FIND "${text}" "${part}" place)
    if(place LESS 0)
      _contactspline_fail("DSP: ${arg_DSP} has an effect, and ${folder}/lv2.cpp no place for it; allowed: lv2.cpp of Faust 2.54")
    endif()
  endforeach()
  set(architecture "${effect_folder}/lv2_with_effect.cpp")  # a name that Faust has not
  file(CONFIGURE OUTPUT "${architecture}" CONTENT "${text}" @ONLY)
  return(PROPAGATE architecture)
endfunction()

# Adds the effect to what a program is compiled of.
function(_contactspline_add_effect target)
  if(has_effect)
    target_sources(${target} PRIVATE "${effect_folder}/effect.h")
    target_include_directories(${target} PRIVATE "${effect_folder}")
  endif()
endfunction()

# Links compiled instruments and vectorised kernels to what a C++ file goes into.
function(_contactspline_kernels target)
  if(arg_DSP MATCHES "\\.cpp$")
    _contactspline_link_engine(${target})
  endif()
endfunction()

# How Faust's own scripts compile what it writes. Its architecture files are not ours to warn about.
function(_contactspline_faust_options target)
  target_compile_features(${target} PRIVATE cxx_std_11)
  if(arg_DSP MATCHES "\\.cpp$")
    target_compile_features(${target} PRIVATE cxx_std_20)
    target_link_libraries(${target} PRIVATE ContactSpline::materials ${arg_MATERIALS})
  endif()
  _contactspline_kernels(${target})
  # -ffast-math costs the runtime digits in single precision: 6 dB on the string C7.
  if(arg_DSP MATCHES "\\.cpp$")
    target_compile_options(${target} PRIVATE -O3 -fno-math-errno -fno-trapping-math -w)
  else()
    target_compile_options(${target} PRIVATE -Ofast -w)
  endif()
  # jack-console.cpp minds NVOICES where it differs from NUM_VOICES only.
  target_compile_definitions(${target} PRIVATE NVOICES=${arg_VOICES} NUM_VOICES=-1)
  target_include_directories(${target} SYSTEM PRIVATE "${FAUST_INCLUDE_DIR}" "${CONTACTSPLINE_BOOST_INCLUDE_DIR}")
endfunction()

# See the top of this file.
function(contactspline_lv2)
  set(_contactspline_function contactspline_lv2)
  _contactspline_faust_arguments(URI ${ARGN})
  _contactspline_class_name()
  _contactspline_find(lv2 lv2-dev)
  if(NOT DEFINED arg_URI)
    set(arg_URI urn:contactspline:${stem})
  endif()
  set(bundle "${arg_OUTPUT_DIR}/${stem}.lv2")
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}.cpp")
  set(effect_folder "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_effect")
  set(architecture lv2.cpp)
  if(has_effect)
    _contactspline_lv2_with_effect()
  endif()
  _contactspline_faust_step("${source}" ${architecture} -cn ${stem})  # the class is called as the plug-in's binary

  set(objects ${arg_TARGET}_objects)
  add_library(${objects} OBJECT "${source}")
  _contactspline_faust_options(${objects})
  _contactspline_add_effect(${objects})
  # Without tunings, which would be those of whoever builds.
  target_compile_definitions(${objects} PRIVATE PLUGIN_URI="${arg_URI}" FAUST_MTS=0)
  set_target_properties(${objects} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
  target_link_libraries(${objects} PRIVATE PkgConfig::CONTACTSPLINE_LV2)

  # As a program it describes its ports.
  set(describe ${arg_TARGET}_describe)
  add_executable(${describe} $<TARGET_OBJECTS:${objects}>)
  set_target_properties(${describe} PROPERTIES LINKER_LANGUAGE CXX)
  _contactspline_kernels(${describe})
  set(manifest "${bundle}/manifest.ttl")
  file(CONFIGURE OUTPUT "${manifest}" @ONLY CONTENT
"@prefix lv2:  <http://lv2plug.in/ns/lv2core#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .

<@arg_URI@>
	a lv2:Plugin ;
	lv2:binary <@stem@@CMAKE_SHARED_MODULE_SUFFIX@> ;
	rdfs:seeAlso <@stem@.ttl> .
")
  set(description "${bundle}/${stem}.ttl")
  add_custom_command(
    OUTPUT "${description}"
    COMMAND ${describe} > "${description}" 2> "${CMAKE_CURRENT_BINARY_DIR}/${describe}.log"
    # Faust 2.54 names units by a property that LV2 does not have. It tells the author and the version of what it does
    # not call a project; a project has no version there.
    COMMAND sed -i -e s/units:name/rdfs:label/ -e "s/a lv2:Plugin/a doap:Project, lv2:Plugin/" -e /doap:revision/d "${description}"
    DEPENDS ${describe}
    COMMENT "Describing ${stem}.lv2"
    VERBATIM)

  add_library(${arg_TARGET} MODULE $<TARGET_OBJECTS:${objects}> "${description}")
  set_target_properties(${arg_TARGET} PROPERTIES
    LINKER_LANGUAGE CXX LINK_DEPENDS "${description}"
    PREFIX "" OUTPUT_NAME ${stem} LIBRARY_OUTPUT_DIRECTORY "$<1:${bundle}>")
  _contactspline_kernels(${arg_TARGET})
endfunction()

# See the top of this file.
function(contactspline_jack)
  set(_contactspline_function contactspline_jack)
  _contactspline_faust_arguments(INSTRUMENT ${ARGN})
  if(arg_DSP MATCHES "\\.cpp$")
    _contactspline_class_name()
  endif()
  _contactspline_find(jack libjack-jackd2-dev alsa libasound2-dev)
  find_package(Threads REQUIRED)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}.cpp")
  set(effect_folder "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_effect")
  _contactspline_faust_step("${source}" jack-console.cpp)
  add_executable(${arg_TARGET} "${source}")
  _contactspline_faust_options(${arg_TARGET})
  _contactspline_add_effect(${arg_TARGET})
  target_compile_definitions(${arg_TARGET} PRIVATE MIDICTRL $<$<BOOL:${has_effect}>:POLY2>)
  target_link_libraries(${arg_TARGET} PRIVATE PkgConfig::CONTACTSPLINE_JACK PkgConfig::CONTACTSPLINE_ALSA Threads::Threads)
  set_target_properties(${arg_TARGET} PROPERTIES OUTPUT_NAME ${stem} RUNTIME_OUTPUT_DIRECTORY "$<1:${arg_OUTPUT_DIR}>")
endfunction()
