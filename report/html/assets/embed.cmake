# cmake -D SCRIPTS= -D CSS= -D ASSETS= -P embed.cmake
# Writes ASSETS, the C++ source of report_assets(), and beside it ASSETS.css and ASSETS.script.
file(READ ${CSS} css)
set(script "(() => {\n\"use strict\";\n")
foreach(file ${SCRIPTS})
  file(READ ${file} part)
  string(APPEND script "\n${part}")
endforeach()
string(APPEND script "})();\n")

string(REPEAT "." 40 row)
set(source "#include \"report/html/assets/assets.h\"\n\nnamespace axisfit {\nnamespace {\n")
foreach(asset css script)
  string(TOLOWER "${${asset}}" lower)
  if(lower MATCHES "</(script|style)|<!--")
    message(FATAL_ERROR "The ${asset} of report.html has ${CMAKE_MATCH_0}, which would end it.")
  endif()
  # Through a file, since only that gives the bytes. A zero at the end, as no array is empty.
  file(WRITE ${ASSETS}.${asset} "${${asset}}")
  file(READ ${ASSETS}.${asset} bytes HEX)
  string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND source "\nconstexpr unsigned char k_${asset}[] = {\n${bytes}0};\n")
endforeach()
string(APPEND source "
/// The bytes before the zero at the end.
template <std::size_t n>
std::string_view text(const unsigned char (&bytes)[n]) {
  return {reinterpret_cast<const char*>(bytes), n - 1};
}

}  // namespace

const ReportAssets& report_assets() {
  static const ReportAssets assets{text(k_css), text(k_script)};
  return assets;
}

}  // namespace axisfit
")
file(WRITE ${ASSETS} "${source}")
