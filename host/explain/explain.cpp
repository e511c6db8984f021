#include "explain/explain.hpp"

#include "contract_io/file_io.hpp"
#include "explain/explain_json.hpp"
#include "explain/explain_page.hpp"
#include "html/page.hpp"

namespace beltpick::explain {

Result<void> write_explanation(const std::filesystem::path& folder, const Explained& explained) {
  if (auto made = contract_io::make_folder(folder); !made) return made;
  const auto chapters = chapters_of(explained.located, explained.recorder.searches());
  const auto body = explanation_body(folder, explained, chapters);
  if (!body) return std::unexpected(body.error());
  if (auto written = contract_io::write_file(folder / "explain.json", explanation_json(explained, chapters)); !written)
    return written;
  return contract_io::write_file(folder / "index.html", html::page("Why: " + explained.capture, *body));
}

}  // namespace beltpick::explain
