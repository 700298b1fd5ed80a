# contactspline_plugin(TARGET name INSTRUMENT name | HEADER file CLASS type [MATERIALS target...] [FORMATS format...]
#                      [INPUTS 0|1] [TITLE text] [VENDOR text] [ID text] [URI uri] [OUTPUT_DIR folder])
#
# Makes plug-ins of an instrument, by the DISTRHO Plugin Framework: OUTPUT_DIR/clap/TARGET.clap,
# OUTPUT_DIR/vst3/TARGET.vst3 and OUTPUT_DIR/lv2/TARGET.lv2. The build target TARGET builds all of them, TARGET_clap and
# so on one each. For Linux and Windows.
#
# INSTRUMENT  the name of an instrument that ships: a file of instruments, a keyboard on its body such as piano, or
#             hammer_string; or of an instrument in MATERIALS
# HEADER      a C++ file, relative to the current source folder, or a name on the include path
# CLASS       a class in it that meets contactspline::Instrument and is built without arguments:
#             "my::Kalimba<float>"
# MATERIALS   targets of contactspline_generate with EMIT cpp, and other libraries that the class needs
# FORMATS     clap, vst3, lv2; default: all
# INPUTS      1: the plug-in has an audio input that pushes the body; default: 1 for an instrument that ships and has
#             an input, else 0
# TITLE       name that hosts show; default: TARGET in words
# VENDOR      of the plug-in; default: Contact Spline
# ID          identity of the plug-in in CLAP and VST3, never to change; default: contactspline.TARGET
# URI         the same in LV2; default: urn:contactspline:TARGET
# OUTPUT_DIR  relative to the current binary folder; default: that folder
#
# Each has a window, drawn by OpenGL: on Linux with the headers of libgl-dev and libx11-dev. Without them, or with
# -DCONTACTSPLINE_PLUGIN_WINDOW=OFF, plug-ins have none. CLAP and VST3 are then not linked to these libraries; LV2's
# window is always a library of its own.
#
# To install: install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/clap DESTINATION lib), and so on.

cmake_policy(VERSION 3.25)  # whatever the caller's
include(${CMAKE_CURRENT_LIST_DIR}/ContactSplineArguments.cmake)

# In the source tree, else where the package is installed.
find_path(ContactSpline_PLUGIN_DIR instrument_plugin.hpp NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH NO_CACHE
          PATHS "${CMAKE_CURRENT_LIST_DIR}/../hosts/plugin" "${ContactSpline_DATA_DIR}/plugin")

option(CONTACTSPLINE_PLUGIN_WINDOW "Give plug-ins a window, where the headers of OpenGL are found" ON)

# Adds the framework's graphics, contactspline_window_graphics, if plug-ins are to have windows.
function(_contactspline_find_graphics)
  if(TARGET contactspline_window_graphics)
    return()
  endif()
  if(NOT CONTACTSPLINE_PLUGIN_WINDOW)
    message(STATUS "Contact Spline: plug-ins have no window, by CONTACTSPLINE_PLUGIN_WINDOW")
    return()
  endif()
  set(OpenGL_GL_PREFERENCE LEGACY)
  if(WIN32)  # which has all of it
    set(libraries opengl32 gdi32 comdlg32)
  else()
    find_package(OpenGL QUIET)
    find_package(X11 QUIET)
    set(libraries ${OPENGL_gl_LIBRARY} ${X11_X11_LIB} ${CMAKE_DL_LIBS})
  endif()
  if(NOT WIN32 AND NOT (OPENGL_FOUND AND X11_FOUND))
    message(STATUS "Contact Spline: plug-ins have no window, for which headers are missing; Debian has them as: "
                   "libgl-dev libx11-dev")
    return()
  endif()
  set(sources Application ApplicationPrivateData Color EventHandlers Geometry ImageBase NanoVG OpenGL Resources SubWidget
              SubWidgetPrivateData TopLevelWidget TopLevelWidgetPrivateData Widget WidgetPrivateData Window
              WindowPrivateData pugl)
  list(TRANSFORM sources REPLACE "(.+)" "${DPF_DIR}/dgl/src/\\1.cpp")
  add_library(contactspline_window_graphics STATIC EXCLUDE_FROM_ALL ${sources})
  set_target_properties(contactspline_window_graphics PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
  target_compile_features(contactspline_window_graphics PUBLIC cxx_std_20)
  target_compile_options(contactspline_window_graphics PRIVATE -w $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
  target_compile_definitions(contactspline_window_graphics PUBLIC DGL_OPENGL HAVE_OPENGL HAVE_DGL
    DGL_FILE_BROWSER_DISABLED $<$<NOT:$<BOOL:${WIN32}>>:HAVE_X11>)
  target_include_directories(contactspline_window_graphics SYSTEM PUBLIC "${DPF_DIR}/dgl"
    PRIVATE "${DPF_DIR}/distrho" "${DPF_DIR}/dgl/src/pugl-upstream/include")
  target_link_libraries(contactspline_window_graphics PUBLIC ${libraries})
endfunction()

# Links the compiled instruments and the vectorised kernels, where they were built.
function(_contactspline_link_engine target)
  target_link_libraries(${target} PRIVATE $<TARGET_NAME_IF_EXISTS:ContactSpline::engine> $<TARGET_NAME_IF_EXISTS:ContactSpline::simd>)
endfunction()

# Checks what has to be installed, and adds the program that writes the description of an LV2 plug-in.
function(_contactspline_find_framework)
  if(NOT CMAKE_SYSTEM_NAME MATCHES "^(Linux|Windows)$")
    _contactspline_fail("${CMAKE_SYSTEM_NAME}; allowed: Linux, Windows")
  endif()
  find_path(DPF_DIR distrho/DistrhoPluginMain.cpp PATHS /usr/share/dpf /usr/local/share/dpf NO_CMAKE_FIND_ROOT_PATH
            DOC "Folder of the DISTRHO Plugin Framework")
  if(NOT DPF_DIR)
    _contactspline_fail("the DISTRHO Plugin Framework is not installed; Debian has it as: dpf-source. Allowed:
                         -DDPF_DIR=FOLDER")
  endif()
  if(NOT TARGET contactspline_describe_lv2)
    add_executable(contactspline_describe_lv2 "${ContactSpline_PLUGIN_DIR}/describe_lv2.cpp")
    target_compile_features(contactspline_describe_lv2 PRIVATE cxx_std_20)
    target_include_directories(contactspline_describe_lv2 PRIVATE
      $<$<BOOL:${WIN32}>:${ContactSpline_PLUGIN_DIR}/windows>)
    target_link_libraries(contactspline_describe_lv2 PRIVATE ${CMAKE_DL_LIBS})
  endif()
  _contactspline_find_graphics()
endfunction()

# Sets `header` and `class` of arg_INSTRUMENT, and `handle`, the expression that makes it: by the engine where it was built.
function(_contactspline_plugin_class)
  get_target_property(instruments ContactSpline::materials CONTACTSPLINE_INSTRUMENTS)
  get_target_property(keyboards ContactSpline::materials CONTACTSPLINE_KEYBOARDS)
  set(own "")
  foreach(target IN LISTS arg_MATERIALS)
    get_target_property(outputs ${target} CONTACTSPLINE_OUTPUTS)
    if(outputs)
      list(FILTER outputs INCLUDE REGEX "\\.hpp$")
      list(TRANSFORM outputs REPLACE "^.*/|\\.hpp$" "")
      list(APPEND own ${outputs})
    endif()
  endforeach()
  set(class "contactspline::instruments::${arg_INSTRUMENT}<float>")
  if(arg_INSTRUMENT IN_LIST own)
    set(header ${arg_INSTRUMENT}.hpp)
  elseif(arg_INSTRUMENT IN_LIST instruments)
    set(header contactspline/instruments/${arg_INSTRUMENT}.hpp)
  elseif(arg_INSTRUMENT IN_LIST keyboards)
    set(header contactspline/instrument/keyboard_instrument.hpp contactspline/keyboards/${arg_INSTRUMENT}.hpp)
    set(class "contactspline::KeyboardInstrument<contactspline::keyboards::${arg_INSTRUMENT}, float>")
  elseif(arg_INSTRUMENT STREQUAL hammer_string)
    set(header contactspline/instrument/instruments_of.hpp contactspline/materials/felt_c4.hpp
               contactspline/resonators/string_c4.hpp)
    set(class "contactspline::HammerStringOf<contactspline::materials::felt_c4, contactspline::resonators::string_c4, float>")
  else()
    list(JOIN instruments ", " instruments)
    list(JOIN keyboards ", " keyboards)
    list(APPEND own ${instruments} ${keyboards} hammer_string)
    list(JOIN own ", " own)
    _contactspline_fail("INSTRUMENT: no '${arg_INSTRUMENT}' ships or is emitted as cpp by MATERIALS; allowed: ${own}")
  endif()
  get_target_property(with_input ContactSpline::materials CONTACTSPLINE_INPUTS)
  if(NOT DEFINED arg_INPUTS AND arg_INSTRUMENT IN_LIST with_input AND NOT arg_INSTRUMENT IN_LIST own)
    set(arg_INPUTS 1)
  endif()
  list(APPEND header contactspline/host/engine.hpp)
  set(handle "contactspline::handle_of<${class}>")
  if(TARGET ContactSpline::engine)
    set(handle "contactspline::compiled<${class}>")
  endif()
  return(PROPAGATE header class handle arg_INPUTS)
endfunction()

# Checks and completes the arguments; sets `header` and `class`.
function(_contactspline_plugin_arguments)
  set(one TARGET INSTRUMENT HEADER CLASS INPUTS TITLE VENDOR ID URI OUTPUT_DIR)
  _contactspline_parse("${one}" "MATERIALS;FORMATS" "TARGET" ${ARGV})
  if(NOT arg_TARGET MATCHES "^[A-Za-z][A-Za-z0-9_]*$")
    _contactspline_fail("TARGET: '${arg_TARGET}' is not usable; allowed: letters, digits and _, a letter first")
  endif()
  if(DEFINED arg_INSTRUMENT AND (DEFINED arg_HEADER OR DEFINED arg_CLASS))
    _contactspline_fail("INSTRUMENT: stands beside HEADER or CLASS; allowed: INSTRUMENT alone, or HEADER with CLASS")
  elseif(NOT DEFINED arg_INSTRUMENT AND NOT (DEFINED arg_HEADER AND DEFINED arg_CLASS))
    _contactspline_fail("INSTRUMENT: missing; needed: INSTRUMENT, or HEADER with CLASS")
  endif()
  foreach(target IN LISTS arg_MATERIALS)
    if(NOT TARGET ${target})
      _contactspline_fail("MATERIALS: '${target}' is no target; allowed: targets of contactspline_generate and libraries")
    endif()
  endforeach()
  if(NOT DEFINED arg_FORMATS)
    set(arg_FORMATS clap vst3 lv2)
  endif()
  foreach(format IN LISTS arg_FORMATS)
    if(NOT format MATCHES "^(clap|vst3|lv2)$")
      _contactspline_fail("FORMATS: '${format}' is unknown; allowed: clap, vst3, lv2")
    endif()
  endforeach()
  if(DEFINED arg_INPUTS AND NOT arg_INPUTS MATCHES "^[01]$")
    _contactspline_fail("INPUTS: '${arg_INPUTS}' is neither; allowed: 0 and 1")
  endif()
  if(DEFINED arg_INSTRUMENT)
    _contactspline_plugin_class()
  else()
    set(class "${arg_CLASS}")
    set(handle "contactspline::handle_of<${class}>")
    cmake_path(ABSOLUTE_PATH arg_HEADER BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE OUTPUT_VARIABLE header)
    if(NOT EXISTS "${header}")
      set(header "${arg_HEADER}")
    endif()
  endif()
  if(NOT DEFINED arg_INPUTS)
    set(arg_INPUTS 0)
  endif()
  if(NOT DEFINED arg_TITLE)
    string(REGEX REPLACE "_+" " " arg_TITLE "${arg_TARGET}")
  endif()
  if(NOT DEFINED arg_VENDOR)
    set(arg_VENDOR "Contact Spline")
  endif()
  foreach(text TITLE VENDOR)
    if(NOT arg_${text} MATCHES "^[^\"\\\\;]+$")
      _contactspline_fail("${text}: has a quote, a backslash or a semicolon; allowed: other characters")
    endif()
  endforeach()
  if(NOT DEFINED arg_ID)
    set(arg_ID contactspline.${arg_TARGET})
  endif()
  if(NOT DEFINED arg_URI)
    set(arg_URI urn:contactspline:${arg_TARGET})
  endif()
  if(NOT arg_ID MATCHES "^[A-Za-z0-9_.-]+$")
    _contactspline_fail("ID: '${arg_ID}' is not usable; allowed: letters, digits, '.', '_' and '-', such as org.me.my_plugin")
  endif()
  if(NOT arg_URI MATCHES "^[a-z]+:[^\"<>\\ ]+$")
    _contactspline_fail("URI: '${arg_URI}' is no URI; allowed: for instance urn:me:my_plugin")
  endif()
  _contactspline_output_dir()
  list(TRANSFORM one PREPEND arg_)
  return(PROPAGATE ${one} arg_MATERIALS arg_FORMATS header class handle)
endfunction()

# What the sides of a plug-in share.
function(_contactspline_plugin_part part)
  string(SHA256 hash "${arg_ID}")
  string(SUBSTRING "${hash}" 0 8 hash)
  target_compile_features(${part} PRIVATE cxx_std_20)
  string(TOUPPER ${format} upper_format)
  target_compile_definitions(${part} PRIVATE DISTRHO_PLUGIN_TARGET_${upper_format} DISTRHO_PLUGIN_NAME="${arg_TITLE}"
    DISTRHO_PLUGIN_BRAND="${arg_VENDOR}" DISTRHO_PLUGIN_URI="${arg_URI}" DISTRHO_PLUGIN_CLAP_ID="${arg_ID}"
    DISTRHO_PLUGIN_NUM_INPUTS=${arg_INPUTS}
    CONTACTSPLINE_HAS_WINDOW=$<TARGET_EXISTS:contactspline_window_graphics> CONTACTSPLINE_PLUGIN_LABEL="${arg_TARGET}" CONTACTSPLINE_PLUGIN_UNIQUE_ID=0x${hash})
  target_include_directories(${part} PRIVATE "${ContactSpline_PLUGIN_DIR}")
  target_include_directories(${part} SYSTEM PRIVATE "${DPF_DIR}/distrho")
  target_compile_options(${part} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)  # hosts can unload it
  set_target_properties(${part} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_link_libraries(${part} PRIVATE ContactSpline::materials ${arg_MATERIALS})
  _contactspline_link_engine(${part})
endfunction()

# Sets `text` to the framework's source of a format, CLAP or VST3, with the types of shared_values.hpp in place of those
# that it lets several threads use at the same time.
function(_contactspline_framework_source name)
  set(framework "${DPF_DIR}/distrho/src/DistrhoPlugin${name}.cpp")
  file(READ "${framework}" text)
  set(change_1 "(float|bool)(\\* (values|changed|fCachedParameterValues|fParameterValue[a-zA-Z]+))" "SharedValue<\\1>\\2")
  set(change_2 "new (float|bool)(.(numParameters|extraParameterCount))" "new SharedValue<\\1>\\2")
  set(change_3 "(d_isEqual)(\\((curValue, )?fCached)" "\\1<float>\\2")
  set(change_4 "SmallStack((Ring)?Buffer)" "Shared\\1")
  foreach(i RANGE 1 4)
    list(GET change_${i} 0 pattern)
    list(GET change_${i} 1 replacement)
    string(REGEX REPLACE "${pattern}" "${replacement}" changed "${text}")
    if(changed STREQUAL text)
      _contactspline_fail("${framework} has no '${pattern}'; allowed: version 1.6 of the framework")
    endif()
    set(text "${changed}")
  endforeach()
  string(PREPEND text "#include \"shared_values.hpp\"\n")
  return(PROPAGATE framework text)
endfunction()

# Replaces what stands in `text`, source of the framework.
macro(_contactspline_replace old new)
  string(REPLACE "${old}" "${new}" changed "${text}")
  if(changed STREQUAL text)
    _contactspline_fail("${framework} has no '${old}'; allowed: version 1.6 of the framework")
  endif()
  set(text "${changed}")
endmacro()

# Writes instrument_clap.cpp into a folder: the framework's source. It allocates its queue of clicks by malloc() and frees
# it by delete[], and needs a host that hears of latencies. The functions that clap.cpp defines itself get another name there.
function(_contactspline_clap_source folder)
  _contactspline_framework_source(CLAP)
  _contactspline_replace("delete[] events;" "std::free(events);")
  _contactspline_replace("fHostExtensions.latency->changed(fHost);"
                         "if (fHostExtensions.latency != nullptr) fHostExtensions.latency->changed(fHost);")
  _contactspline_replace("class PluginCLAP : ClapEventQueue\n{\npublic:\n"
                         "class PluginCLAP : ClapEventQueue\n{\npublic:\n    void* instrument() { return fPlugin.getInstancePointer(); }\n")
  # Where the framework takes the address of one, it gets that of clap.cpp.
  foreach(name plugin_reset plugin_process plugin_get_extension plugin_params_get_info plugin_params_get_value
          plugin_params_value_to_text plugin_params_text_to_value plugin_params_flush plugin_state_save plugin_state_load
          plugin_entry_init plugin_entry_deinit get_plugin_descriptor create_plugin)
    _contactspline_replace("clap_${name}(" "clap_${name}_of_framework(")
  endforeach()
  file(CONFIGURE OUTPUT "${folder}/instrument_clap.cpp" @ONLY CONTENT "${text}")
endfunction()

# Writes instrument_vst3.cpp into a folder: the framework's source, with InstrumentVst3 of instrument_vst3.hpp in place of
# its class PluginVst3.
function(_contactspline_vst3_source folder)
  _contactspline_framework_source(VST3)
  string(FIND "${text}" "static uint32_t V3_API dpf_static_ref(void*)" place)
  string(SUBSTRING "${text}" 0 ${place} class)
  string(SUBSTRING "${text}" ${place} -1 rest)
  string(REPLACE "\nprivate:\n    // Plugin\n" "\nprotected:\n" class_of_instrument "${class}")
  string(REPLACE "double _getNormalizedParameterValue(" "virtual double _getNormalizedParameterValue(" class_of_instrument "${class_of_instrument}")
  string(REPLACE "PluginVst3" "InstrumentVst3" rest "${rest}")
  foreach(object edit_controller component)
    string(REPLACE edit_ "" self ${object})
    string(REGEX REPLACE "query_interface_${object}\\(void\\* const self, const v3_tuid iid, void\\*\\* const iface\\)\n    {\n[^\n]*\n"
      "\\0
        if (void* const object = ${self}->vst3 != nullptr ? ${self}->vst3->interface(iid) : nullptr)
        {
            *iface = object;
            return V3_OK;
        }
" changed "${rest}")
    if(changed STREQUAL rest)
      set(place -1)
    endif()
    set(rest "${changed}")
  endforeach()
  if(place LESS 0 OR class_of_instrument STREQUAL class OR NOT class_of_instrument MATCHES "virtual double _get")
    _contactspline_fail("${framework} has no place for InstrumentVst3; allowed: version 1.6 of the framework")
  endif()
  file(CONFIGURE OUTPUT "${folder}/instrument_vst3.cpp" @ONLY CONTENT
    "${class_of_instrument}END_NAMESPACE_DISTRHO\n#include \"instrument_vst3.hpp\"\nSTART_NAMESPACE_DISTRHO\n${rest}")
endfunction()

# The window in CLAP or VST3, contactspline_window_FORMAT: one for all plug-ins, of which the framework asks for names
# that it then does not show.
function(_contactspline_window)
  set(window contactspline_window_${format})
  if(TARGET ${window})
    return()
  endif()
  set(arg_TITLE "window")
  set(arg_VENDOR "Contact Spline")
  set(arg_TARGET window)
  set(arg_ID contactspline.window)
  set(arg_URI urn:contactspline:window)
  set(arg_MATERIALS "")
  set(arg_INPUTS 0)
  add_library(${window} OBJECT EXCLUDE_FROM_ALL "${ContactSpline_PLUGIN_DIR}/window.cpp")
  target_compile_options(${window} PRIVATE -w -O1)
  _contactspline_plugin_part(${window})
  target_link_libraries(${window} PRIVATE contactspline_window_graphics)
endfunction()

# The window of the LV2 plug-in: TARGET_ui.so beside it.
function(_contactspline_lv2_window)
  set(window ${target}_window)
  add_library(${window} MODULE "${ContactSpline_PLUGIN_DIR}/window.cpp")
  target_compile_options(${window} PRIVATE -w -O1)
  _contactspline_plugin_part(${window})
  target_link_libraries(${window} PRIVATE contactspline_window_graphics)
  if(WIN32)
    target_link_libraries(${window} PRIVATE "${DPF_DIR}/utils/symbols/lv2-ui.def")
  else()
    target_link_options(${window} PRIVATE "-Wl,--version-script=${DPF_DIR}/utils/symbols/lv2-ui.version")
  endif()
  set_target_properties(${window} PROPERTIES
    PREFIX "" OUTPUT_NAME ${arg_TARGET}_ui SUFFIX ${suffix_of_lv2} LIBRARY_OUTPUT_DIRECTORY "$<1:${folder}>")
  add_dependencies(${target} ${window})
endfunction()

# The binary of one format.
function(_contactspline_plugin_format format)
  set(target ${arg_TARGET}_${format})
  set(symbols "${DPF_DIR}/utils/symbols/${format}")
  if(format STREQUAL lv2)
    set(symbols "${DPF_DIR}/utils/symbols/lv2-dsp")
  endif()
  set(instrument ${arg_TARGET}_instrument)
  # The framework's side: not ours to warn about, and nothing in it takes time.
  add_library(${target} MODULE "${ContactSpline_PLUGIN_DIR}/${format}.cpp" $<TARGET_OBJECTS:${instrument}>)
  if(NOT format STREQUAL lv2)
    set(framework "${CMAKE_CURRENT_BINARY_DIR}/contactspline_${format}")
    cmake_language(CALL _contactspline_${format}_source "${framework}")
    target_include_directories(${target} SYSTEM PRIVATE "${framework}" "${DPF_DIR}/distrho/src")
  endif()
  target_compile_options(${target} PRIVATE -w -O1)
  _contactspline_plugin_part(${target})
  if(TARGET contactspline_window_graphics AND format STREQUAL lv2)
    target_compile_definitions(${target} PRIVATE
      $<TARGET_PROPERTY:contactspline_window_graphics,INTERFACE_COMPILE_DEFINITIONS>)
  elseif(TARGET contactspline_window_graphics)
    _contactspline_window()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:contactspline_window_${format}>)
    target_link_libraries(${target} PRIVATE contactspline_window_graphics)
  endif()
  # Where hosts of the system look for the binary, and what it exports.
  set(folder "${arg_OUTPUT_DIR}/${format}")
  set(suffix_of_clap .clap)
  if(WIN32)
    target_link_libraries(${target} PRIVATE "${symbols}.def")
    set(suffix_of_lv2 .dll)
    set(suffix_of_vst3 .vst3)
    set(system win)
  else()
    target_link_options(${target} PRIVATE "-Wl,--version-script=${symbols}.version")
    set(suffix_of_lv2 .so)
    set(suffix_of_vst3 .so)
    set(system linux)
  endif()
  if(format STREQUAL vst3)
    string(APPEND folder "/${arg_TARGET}.vst3/Contents/${CMAKE_SYSTEM_PROCESSOR}-${system}")
  elseif(format STREQUAL lv2)
    string(APPEND folder "/${arg_TARGET}.lv2")
  endif()
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${arg_TARGET} SUFFIX ${suffix_of_${format}} LIBRARY_OUTPUT_DIRECTORY "$<1:${folder}>")
  if(format STREQUAL lv2)
    if(TARGET contactspline_window_graphics)
      _contactspline_lv2_window()
    endif()
    # Without the words of other vocabularies, which lv2_validate does not know; `options` are welcome, not needed. The
    # window is a library of its own. Lines end as on Linux.
    add_custom_command(TARGET ${target} POST_BUILD
      COMMAND contactspline_describe_lv2 ${arg_TARGET} ${suffix_of_lv2} > describe.log
      COMMAND ${CMAKE_COMMAND} -E rm describe.log
      COMMAND sed -zi -E -e "s/\\r//g; s/ ,\\n *<http:..kxstudio[^>]*>//; s/ *mod:(brand|label) [^\\n]*\\n//g"
              -e "s/(requiredFeature) opts:options ,\\n */\\1 /; s/(optionalFeature) /\\1 opts:options, /"
              -e "s/(ui:binary <[^>]*)(\\.[a-z]+>)/\\1_ui\\2/"
              -e "s/(lv2:symbol .latency. ;)/\\1 lv2:designation lv2:latency ; lv2:portProperty lv2:reportsLatency ;/"
              ${arg_TARGET}.ttl presets.ttl manifest.ttl
      WORKING_DIRECTORY "${folder}"
      COMMENT "Describing ${arg_TARGET}.lv2"
      VERBATIM)
    add_dependencies(${target} contactspline_describe_lv2)
  endif()
endfunction()

# See the top of this file.
function(contactspline_plugin)
  set(_contactspline_function contactspline_plugin)
  _contactspline_plugin_arguments(${ARGV})
  _contactspline_find_framework()
  list(TRANSFORM header REPLACE "(.+)" "#include \"\\1\"\n")
  list(JOIN header "" includes)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${arg_TARGET}_plugin.cpp")
  file(CONFIGURE OUTPUT "${source}" @ONLY CONTENT
"@includes@#include \"instrument_plugin.hpp\"

DISTRHO_NAMESPACE::Plugin* DISTRHO_NAMESPACE::createPlugin() {
  return new contactspline::InstrumentPlugin(+[] { return @handle@(); });
}
")
  # The instrument's side is the same in all formats: see without_states.hpp.
  list(GET arg_FORMATS 0 format)
  add_library(${arg_TARGET}_instrument OBJECT "${source}")
  _contactspline_plugin_part(${arg_TARGET}_instrument)
  add_custom_target(${arg_TARGET} ALL)
  set_target_properties(${arg_TARGET} PROPERTIES CONTACTSPLINE_HANDLE "${handle}" CONTACTSPLINE_INCLUDES "${includes}")
  foreach(format IN LISTS arg_FORMATS)
    _contactspline_plugin_format(${format})
    add_dependencies(${arg_TARGET} ${arg_TARGET}_${format})
  endforeach()
endfunction()
