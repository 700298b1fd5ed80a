# cmake -DTEXTS=a;b -DFUNCTION=f -DOUTPUT=c.cpp -P EmbedTexts.cmake: the files as string literals that f() returns.
set(entries "")
foreach(text IN LISTS TEXTS)
  get_filename_component(name ${text} NAME)
  if(name MATCHES "\\.mid$")
    file(READ ${text} bytes HEX)
    file(SIZE ${text} size)
    string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${bytes}")
    string(APPEND entries "    {\"${name}\", {\"${bytes}\", ${size}}},\n")
  else()
    file(READ ${text} content)
    string(APPEND entries "    {\"${name}\", R\"~~~(${content})~~~\"},\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "#include \"generator/embedded.hpp\"

namespace contactspline {
namespace {
constexpr EmbeddedText kTexts[] = {
${entries}};
}
std::span<const EmbeddedText> ${FUNCTION}() { return kTexts; }
}  // namespace contactspline
")
