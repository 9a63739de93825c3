#include <fmt/core.h>

#include "pipeline/commands.hpp"
#include "pipeline/figure.hpp"
#include "pipeline/files.hpp"
#include "pipeline/report.hpp"
#include "pipeline/thread_count.hpp"
#include "pipeline/user_error.hpp"

namespace deforma {

int make_figure(const FigureCommand& command) {
  namespace fs = std::filesystem;
  Figure figure = load_figure(find_figure(command.figure));
  const fs::path folder = command.folder;
  std::vector<fs::path> files;
  for (const char* ending : {".png", ".pdf", ".svg"}) files.push_back(folder / (figure.name + ending));
  std::error_code error;
  for (const fs::path& file : files)
    if (!command.overwrite && fs::exists(file, error))
      throw UserError(fmt::format("{}: exists; give another folder with -o, or --overwrite", file.string()));
  fs::create_directories(folder, error);
  if (error) throw UserError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));

  const double dpi = figure.dpi;
  const std::string name = figure.name;
  const Page page =
      on_threads(command.threads, [&] { return make_page(std::move(figure), command.platform); });
  write_page_png(files[0], page, dpi, {{"Software", version_text()}, {"Title", name}});
  for (std::size_t k = 1; k < files.size(); ++k) write_page_vectors(files[k], page);
  if (!command.quiet)
    fmt::print("{:.0f} x {:.0f} mm: {}, .pdf, .svg\n", page.width, page.height, files[0].string());
  return exit_ok;
}

}  // namespace deforma
