# cmake -DTEXTS=a;b -DFUNCTION=f -DOUTPUT=c.cpp -P EmbedTexts.cmake: the files as raw string literals that f() returns.
set(entries "")
foreach(text IN LISTS TEXTS)
  get_filename_component(name ${text} NAME)
  file(READ ${text} content)
  string(APPEND entries "    {\"${name}\", R\"~~~(${content})~~~\"},\n")
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
