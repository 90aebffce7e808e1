/// Escapes what HTML would read as markup.
#include "host/report/filled_page.hpp"

#include "host/files/output_file.hpp"

namespace verisq::report {
namespace {

/// In JSON these characters occur within texts alone.
void write_for_html(OutputFile& file, std::string_view json) {
  while (true) {
    const std::size_t plain = json.find_first_of("<>&");
    file.write(json.substr(0, plain));
    if (plain == std::string_view::npos) return;
    file.write(json[plain] == '<' ? "\\u003c" : json[plain] == '>' ? "\\u003e" : "\\u0026");
    json.remove_prefix(plain + 1);
  }
}

}  // namespace

void write_filled_page(const std::filesystem::path& path, std::string_view page, std::string_view json) {
  constexpr std::string_view marker = "<!--verisq-report-data-->";
  const std::size_t place = page.find(marker);
  OutputFile file(path);
  file.write(page.substr(0, place));
  file.write(R"(<script type="application/json" id="verisq-report">)");
  write_for_html(file, json);
  file.write("</script>");
  file.write(page.substr(place + marker.size()));
  file.finish();
}

}  // namespace verisq::report
