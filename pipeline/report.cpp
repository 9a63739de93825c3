#include "pipeline/report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

namespace deforma {

namespace {

using nlohmann::json;

json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json to_json(const Ledger& ledger) {
  json potential = json::object();
  for (const auto& [effect, energy] : ledger.potential) potential[effect] = energy;
  return {{"kinetic", ledger.kinetic},
          {"potential", potential},
          {"total", ledger.total()},
          {"linear_momentum", to_json(ledger.linear_momentum)},
          {"angular_momentum", to_json(ledger.angular_momentum)}};
}

json to_json(const std::vector<SolverStatistics::Pass>& passes) {
  json list = json::array();
  for (const auto& pass : passes)
    list.push_back(
        {{"name", pass.name}, {"passes", pass.calls}, {"seconds", pass.seconds}, {"bytes", pass.bytes}});
  return list;
}

json to_json(const BodyFacts& body) {
  return {{"name", body.name},           {"particles", body.particles}, {"vertices", body.vertices},
          {"triangles", body.triangles}, {"links", body.links},         {"mass", body.mass},
          {"volume", body.volume},       {"spacing", body.spacing}};
}

json to_json(const ContextFacts& context, const Antialiasing& antialiasing) {
  return {{"antialiasing", name_of(antialiasing)},
          {"platform", context.platform},
          {"vendor", context.vendor},
          {"renderer", context.renderer},
          {"version", context.version},
          {"failed_attempts", context.attempts}};
}

std::string_view name_of(Ending ending) {
  switch (ending) {
    case Ending::interrupted:
      return "interrupted";
    case Ending::diverged:
      return "diverged";
    default:
      return "complete";
  }
}

json to_json(const Load& load) { return {{"busy", load.busy}, {"wait", load.wait}}; }

json stages_of(const RunRecord& record) {
  return {{"build", to_json(record.build)}, {"simulate", to_json(record.simulate)},
          {"skin", to_json(record.skin)},   {"draw", to_json(record.draw)},
          {"png", to_json(record.png)},     {"video", to_json(record.video)}};
}

json to_json(const Coloring& coloring) {
  const auto finite = [](double value) { return std::isfinite(value) ? json(value) : json(); };
  return {{"field", coloring.field->name},
          {"unit", coloring.field->unit},
          {"map", coloring.scale.map->name},
          {"range", {coloring.scale.low, coloring.scale.high}},
          {"automatic", coloring.automatic},
          {"lowest", finite(coloring.values.lowest())},
          {"highest", finite(coloring.values.highest())}};
}

/// Means over the frames [s].
json to_json(const DrawingCost& cost) {
  const double frames = std::max(cost.frames, 1);
  return {{"upload", cost.upload / frames},
          {"shadow", cost.shadow / frames},
          {"shading", cost.shading / frames},
          {"resolve", cost.resolve / frames},
          {"readback", cost.readback / frames}};
}

json time_step_of(const SolverStatistics& statistics) {
  return {{"smallest", statistics.smallest_step},
          {"largest", statistics.largest_step},
          {"substeps", statistics.substeps}};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> library_versions() {
  std::vector<std::pair<std::string, std::string>> versions;
  std::istringstream list(DEFORMA_LIBRARY_VERSIONS);
  for (std::string name, version; list >> name >> version;) versions.emplace_back(name, version);
  return versions;
}

std::string version_text() { return fmt::format("deforma {}", DEFORMA_VERSION); }

std::string make_report(const Scene& scene, const World& world, const RunRecord& record) {
  const SolverStatistics& statistics = world.solver->statistics();
  double per_substep =
      statistics.substeps == 0 ? 0.0 : record.simulate.busy / static_cast<double>(statistics.substeps);
  double rate = record.frames_seconds > 0.0 ? record.frames_written / record.frames_seconds : 0.0;
  json libraries = json::object();
  for (const auto& [name, library_version] : library_versions()) libraries[name] = library_version;
  json report = {
      {"version", DEFORMA_VERSION},
      {"libraries", libraries},
      {"renderer", to_json(record.context, record.antialiasing)},
      {"ending", {{"how", name_of(record.ending)}, {"message", record.ending_message}}},
      {"scene", json::parse(scene_to_json(scene))},
      {"bodies", json::array()},
      {"frames", record.frames_written},
      {"seconds", record.seconds},
      {"stage_seconds", stages_of(record)},
      {"drawing_seconds_per_frame", to_json(record.drawing)},
      {"frames_per_second", rate},
      {"milliseconds_per_iteration", 1e3 * per_substep},
      {"paper", {{"FPS", rate}, {"TPIS", per_substep}}},
      {"time_step", time_step_of(statistics)},
      {"solver_stages", to_json(statistics.stages)},
      {"effects", to_json(statistics.effects)},
      {"ledger", {{"first_frame", to_json(record.first)}, {"last_frame", to_json(record.last)}}},
      {"warnings", world.warnings},
  };
  if (record.coloring) report["color"] = to_json(*record.coloring);
  for (const BodyFacts& body : world.bodies) report["bodies"].push_back(to_json(body));
  return report.dump(2) + "\n";
}

}  // namespace deforma
