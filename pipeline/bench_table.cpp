#include "pipeline/bench_table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/report.hpp"

namespace deforma {

namespace {

using json = nlohmann::ordered_json;  // columns as in the text

std::string cell_text(const BenchTable::Cell& cell, int decimals) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  const double number = std::get<double>(cell);
  return std::isfinite(number) ? fmt::format("{:.{}f}", number, decimals) : "-";
}

std::string heading_line(const std::string& heading, int line) {
  const std::size_t end = heading.find('\n');
  if (end == heading.npos) return line == 0 ? "" : heading;
  return line == 0 ? heading.substr(0, end) : heading.substr(end + 1);
}

/// Text to the left of its column, numbers to the right.
std::string padded(const std::string& text, std::size_t width, bool number) {
  return number ? fmt::format("{:>{}}", text, width) : fmt::format("{:<{}}", text, width);
}

bool holds_numbers(const BenchTable& table, std::size_t column) {
  return !table.rows.empty() && std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) {
    return std::holds_alternative<double>(row[column]);
  });
}

void trim_end(std::string& line) { line.erase(line.find_last_not_of(' ') + 1); }

}  // namespace

std::string bench_text(const BenchTable& table) {
  // Two lines of headings, then the rows.
  std::vector<std::string> lines(2 + table.rows.size());
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const BenchColumn& column = table.columns[c];
    const bool numbers = holds_numbers(table, c);
    std::vector<std::string> cells = {heading_line(column.heading, 0), heading_line(column.heading, 1)};
    for (const auto& row : table.rows) cells.push_back(cell_text(row[c], column.decimals));
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
      lines[k] += (c > 0 ? "  " : "") + padded(cells[k], width, numbers);
  }
  std::string text = table.title + "\n";
  for (std::string& line : lines) {
    trim_end(line);
    if (!line.empty()) text += line + "\n";
  }
  for (const std::string& note : table.notes) text += note + "\n";
  return text;
}

std::string bench_text(const BenchMachine& machine) {
  return fmt::format(
      "{} on {}, {} processor{}\n"
      "memory bandwidth (triad): {:.1f} GB/s on one thread, {:.1f} GB/s on {} threads\n",
      version_text(), machine.processor, machine.processors, machine.processors == 1 ? "" : "s",
      1e-9 * machine.bandwidth, 1e-9 * machine.bandwidth_all, machine.threads);
}

std::string bench_json(const BenchMachine& machine, const std::vector<BenchTable>& tables) {
  json all = {{"version", version_text()},
              {"machine",
               {{"processor", machine.processor},
                {"processors", machine.processors},
                {"threads", machine.threads},
                {"bandwidth_bytes_per_second", machine.bandwidth},
                {"bandwidth_all_threads_bytes_per_second", machine.bandwidth_all}}}};
  for (const BenchTable& table : tables) {
    json& rows = all[table.name] = json::array();
    for (const auto& row : table.rows) {
      json object = json::object();
      for (std::size_t c = 0; c < row.size(); ++c)
        std::visit([&](const auto& value) { object[table.columns[c].key] = value; }, row[c]);
      rows.push_back(std::move(object));
    }
  }
  return all.dump(2) + "\n";
}

}  // namespace deforma
