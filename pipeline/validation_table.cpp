#include "pipeline/validation_table.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace deforma {

namespace {

constexpr std::size_t columns = 14;
using Cells = std::array<std::string, columns>;

const Cells header = {"case",      "quantity", "arrangement", "setting", "n",     "particles", "value",
                      "reference", "unit",     "error",       "goal",    "limit", "verdict",   "CPU [s]"};
constexpr std::array<bool, columns> to_the_right = {false, false, false, false, true, true,  true,
                                                    true,  false, true,  true,  true, false, true};

std::string number(double value) { return std::isnan(value) ? "none" : fmt::format("{:.5g}", value); }

std::string ratio(const Criterion& criterion, double value, bool with_sign) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return "-";
  if (criterion.comparison == Comparison::at_most) return fmt::format("{:.3g}", value);
  return with_sign ? fmt::format("{:+.2f} %", 100.0 * value) : fmt::format("{:g} %", 100.0 * value);
}

Cells cells_of(const ValidationRow& row) {
  const Criterion& c = *row.criterion;
  const Bounds& bounds = c.bounds(row.variant.n);
  const bool judged = row.judged();
  return {std::string(c.case_name),
          std::string(c.quantity),
          std::string(placement_name(row.variant.placement)),
          row.variant.setting->name,
          fmt::format("{}", row.variant.n),
          fmt::format("{}", row.particles),
          number(row.value),
          number(c.reference),
          std::string(c.unit),
          ratio(c, c.error(row.value), true),
          judged ? ratio(c, bounds.goal, false) : "",
          judged ? ratio(c, bounds.limit, false) : "",
          std::string(verdict_name(row.verdict())),
          fmt::format("{:.2f}", row.cpu)};
}

std::string row_name(const ValidationRow& row) {
  return fmt::format("{}, {}, {}, n = {}", row.criterion->case_name, placement_name(row.variant.placement),
                     row.variant.setting->name, row.variant.n);
}

/// One line for every quantity in the rows.
std::vector<std::string> sources(const std::vector<ValidationRow>& rows) {
  std::vector<std::string> lines;
  const Criterion* last = nullptr;
  for (const ValidationRow& row : rows) {
    if (row.criterion == last) continue;
    last = row.criterion;
    lines.push_back(fmt::format("{}, {}: {}{} ({})", last->case_name, last->quantity, number(last->reference),
                                last->unit == "-" ? "" : fmt::format(" {}", last->unit), last->source));
  }
  return lines;
}

std::vector<std::string> settings(const std::vector<ValidationRow>& rows) {
  std::vector<std::string> lines;
  for (const ValidationSetting& setting : validation_settings()) {
    bool used = std::any_of(rows.begin(), rows.end(),
                            [&](const ValidationRow& row) { return row.variant.setting == &setting; });
    if (used)
      lines.push_back(fmt::format("{}: {}{}", setting.name, setting.meaning,
                                  setting.judged ? "" : "; shown, not judged"));
  }
  return lines;
}

/// Why there is no value, or a strain too large for the reference; one line for every run.
std::vector<std::string> troubles(const std::vector<ValidationRow>& rows) {
  std::vector<std::string> lines;
  for (const ValidationRow& row : rows) {
    std::string line;
    if (!row.trouble.empty())
      line = fmt::format("{}: {}", row_name(row), row.trouble);
    else if (row.small && !(row.strain <= small_strain))
      line = fmt::format("{}: the largest strain is {:.2g}, above {:g}", row_name(row), row.strain,
                         small_strain);
    if (!line.empty() && std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

/// Judged quantities whose error has not fallen from the fewest to the most particles across, by more than one tenth of
/// the limit: what is near zero may wander there.
std::vector<std::string> not_converging(const std::vector<ValidationRow>& rows) {
  std::vector<std::string> lines;
  for (const ValidationRow& first : rows) {
    const Criterion& c = *first.criterion;
    if (!first.judged() || c.comparison != Comparison::relative || !std::isfinite(c.fine.limit)) continue;
    const ValidationRow* least = &first;
    const ValidationRow* most = &first;
    for (const ValidationRow& row : rows) {
      if (row.criterion != &c || row.variant.setting != first.variant.setting ||
          row.variant.placement != first.variant.placement)
        continue;
      if (row.variant.n < least->variant.n) least = &row;
      if (row.variant.n > most->variant.n) most = &row;
    }
    if (&first != least) continue;  // once for each
    double few = std::abs(c.error(least->value)), many = std::abs(c.error(most->value));
    if (many > few + 0.1 * c.fine.limit)
      lines.push_back(fmt::format("{}, {}, {}: off by {:.2f} % at n = {} and {:.2f} % at n = {}", c.case_name,
                                  c.quantity, placement_name(first.variant.placement), 100.0 * few,
                                  least->variant.n, 100.0 * many, most->variant.n));
  }
  return lines;
}

std::string strains(const std::vector<ValidationRow>& rows) {
  double largest = 0.0;
  for (const ValidationRow& row : rows)
    if (row.small) largest = std::max(largest, row.strain);
  return fmt::format(
      "Largest strain in the cases whose references hold for small strain: {:.2g} (allowed {:g})", largest,
      small_strain);
}

std::string summary(const std::vector<ValidationRow>& rows) {
  std::array<int, 4> count{};
  for (const ValidationRow& row : rows) ++count[static_cast<std::size_t>(row.verdict())];
  return fmt::format("{} ok, {} missed their goal, {} FAILED their limit, {} shown without", count[0],
                     count[1], count[2], count[3]);
}

std::string paragraph(std::string_view title, const std::vector<std::string>& lines,
                      std::string_view bullet) {
  if (lines.empty()) return "";
  std::string text = fmt::format("\n{}\n", title);
  if (bullet == "* ") text += "\n";
  for (const std::string& line : lines) text += fmt::format("{}{}\n", bullet, line);
  return text;
}

std::string notes(const std::vector<ValidationRow>& rows, std::string_view bullet) {
  return paragraph("Settings:", settings(rows), bullet) + paragraph("References:", sources(rows), bullet) +
         paragraph("Trouble:", troubles(rows), bullet) +
         paragraph("Not converging:", not_converging(rows), bullet) +
         fmt::format("\n{}.\n{}.\n", strains(rows), summary(rows));
}

/// A field of a CSV file, quoted where it must be.
std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

bool all_limits_kept(const std::vector<ValidationRow>& rows) {
  return std::none_of(rows.begin(), rows.end(),
                      [](const ValidationRow& row) { return row.verdict() == Verdict::failed; });
}

void sort_rows(std::vector<ValidationRow>& rows) {
  auto place = [](const ValidationRow& row) {
    return std::tuple(row.criterion - validation_criteria().data(),
                      row.variant.setting - validation_settings().data(), row.variant.placement,
                      row.variant.n);
  };
  std::sort(rows.begin(), rows.end(),
            [&](const ValidationRow& a, const ValidationRow& b) { return place(a) < place(b); });
}

std::string validation_text(const std::vector<ValidationRow>& rows) {
  std::vector<Cells> table = {header};
  for (const ValidationRow& row : rows) table.push_back(cells_of(row));
  std::array<std::size_t, columns> width{};
  for (const Cells& line : table)
    for (std::size_t c = 0; c < columns; ++c) width[c] = std::max(width[c], line[c].size());
  std::string text;
  for (const Cells& line : table) {
    std::string joined;
    for (std::size_t c = 0; c < columns; ++c)
      joined += to_the_right[c] ? fmt::format("{:>{}}  ", line[c], width[c])
                                : fmt::format("{:<{}}  ", line[c], width[c]);
    joined.erase(joined.find_last_not_of(' ') + 1);
    text += joined + "\n";
  }
  return text + notes(rows, "  ");
}

std::string validation_markdown(const std::vector<ValidationRow>& rows) {
  std::string text = "# Validation\n\n";
  text += fmt::format("| {} |\n|", fmt::join(header, " | "));
  for (bool right : to_the_right) text += right ? "---:|" : "---|";
  text += "\n";
  for (const ValidationRow& row : rows) text += fmt::format("| {} |\n", fmt::join(cells_of(row), " | "));
  return text + notes(rows, "* ");
}

std::string validation_csv(const std::vector<ValidationRow>& rows) {
  std::string text =
      "case,quantity,placement,setting,n,particles,value,reference,unit,error,goal,limit,verdict,largest_"
      "strain,cpu_s,"
      "source,trouble\n";
  for (const ValidationRow& row : rows) {
    const Criterion& c = *row.criterion;
    const Bounds& bounds = c.bounds(row.variant.n);
    const bool judged = row.judged();
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(c.case_name), csv_field(c.quantity),
        placement_name(row.variant.placement), csv_field(row.variant.setting->name), row.variant.n,
        row.particles, csv_number(row.value), csv_number(c.reference), c.unit, csv_number(c.error(row.value)),
        judged ? csv_number(bounds.goal) : "", judged ? csv_number(bounds.limit) : "",
        verdict_name(row.verdict()), csv_number(row.strain), csv_number(row.cpu), csv_field(c.source),
        csv_field(row.trouble));
  }
  return text;
}

}  // namespace deforma
