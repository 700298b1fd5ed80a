# cmake -DFILES=a;b -DFOLDER=name -DOUTPUT=c.cpp -P EmbedFiles.cmake: writes the files as string literals that
# embedded_<FOLDER>() returns.
set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  if(name MATCHES "\\.mid$")
    file(READ ${file} bytes HEX)
    file(SIZE ${file} size)
    string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
    string(APPEND entries "    {\"${name}\", {\"${bytes}\", ${size}}},\n")
  else()
    file(READ ${file} content)
    string(APPEND entries "    {\"${name}\", R\"~~~(${content})~~~\"},\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "#include \"generator/support/embedded_files.hpp\"

namespace contactspline {
namespace {
constexpr EmbeddedFile kFiles[] = {
${entries}};
}
std::span<const EmbeddedFile> detail::embedded_${FOLDER}() { return kFiles; }
}  // namespace contactspline
")
