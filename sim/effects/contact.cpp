#include "sim/effects/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact_body.hpp"
#include "sim/contact_law.hpp"
#include "sim/near_surfaces.hpp"
#include "sim/obstacle_motion.hpp"
#include "sim/parallel.hpp"
#include "sim/triangle_tree.hpp"

namespace deforma {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const Setting settings[] = {
    {.key = "friction",
     .unit = "-",
     .meaning = "Coulomb coefficient; the larger of the two sides' counts",
     .fallback = Curve<double>(0.3),
     .allowed = Interval::non_negative()},
    {.key = "restitution",
     .unit = "-",
     .meaning = "speed after over speed before for a free particle; of two bodies the smaller counts",
     .fallback = Curve<double>(0.3),
     .allowed = Interval::closed(0.0, 1.0)},
    {.key = "stiffness",
     .unit = "-",
     .meaning = "of the surface: its squared frequency in units of (wave speed / spacing)^2",
     .fallback = Curve<double>(4.0),
     .allowed = Interval::positive(),
     .keyframed = false},
    {.key = "bodies", .unit = "-", .meaning = "touches other bodies that have this table", .fallback = true},
    {.key = "self", .unit = "-", .meaning = "touches itself", .fallback = false},
};

// Lengths in spacings.
constexpr double search_margin = 0.5;     // how far obstacles are looked for around a vertex
constexpr double body_margin = 0.25;      // how far bodies move before neighbours are sought again
constexpr double deepest = 1.0;           // inside another body, deeper is not touching any more
constexpr double own_neighborhood = 2.0;  // surface closer at rest does not count as touching itself
constexpr double travel_per_step = 0.25;  // so that nothing passes a surface unseen

constexpr double resolved = 0.07;  // of the stable step, for a free particle's bounce to keep its energy
constexpr double friction_spring = 0.5;    // of the normal one: the sum over a corner's walls stays in bounds
constexpr double friction_damping = 0.25;  // of the stable step: the time constant of damper over spring

// One table, and its body.
struct Side {
  ContactBody body;
  Curve<double> friction, restitution, young;
  bool bodies, self;
  double young_then;        // when the springs were measured [Pa]
  bool paired = false;      // something besides obstacles can be touched
  double softening = 1.0;   // of the springs: Young's modulus now over then
  double stiffening = 1.0;  // of the deepest touch: E'' over k

  // How wide restitution is blended, in the velocity that a touch as deep would have come with: about one
  // step of the motion it damps.
  double blend() const { return body.elastic() ? 1.5 : 0.05; }
  double frequency() const { return body.frequency() * std::sqrt(softening); }
  // The springs of two bodies act on the relative motion: at most twice as stiff for each.
  double stable_step() const {
    const double step = 2.0 / (frequency() * std::sqrt((paired ? 2.0 : 1.0) * stiffening));
    return body.elastic() ? step : resolved * step;
  }
};

// One vertex touching one thing.
struct Contact {
  Index partner;  // an obstacle's number, or the count of obstacles plus a body's
  double depth;   // from where the spring begins
  Vec3 normal;    // the way out
  Vec3 velocity;  // relative
  Penalty penalty;
  double friction, restitution;
  Index triangle = Closest::none;  // of a body, with the place in it
  Vec3 barycentric = Vec3::Zero();
};

struct Answer {
  Vec3 force;
  Index triangle;  // whose corners share the reaction
  Vec3 barycentric;
};

// A vertex that something is near.
struct Candidate {
  Index vertex;
  Index side;
  std::vector<Index> obstacles = {};
  std::vector<NearSurface> surfaces = {};
  std::vector<Slip> slips = {};
  std::vector<Answer> answers = {};  // of this substep
  double stiffening = 1.0;           // of this substep
};

class ContactEffect : public Effect {
 public:
  ContactEffect(const State& state, std::span<const EffectTable> tables)
      : side_of_(state.bodies.size(), Closest::none) {
    for (const EffectTable& table : tables) {
      const Parameters& p = table.parameters;
      const Body& body = state.bodies[table.body];
      side_of_[table.body] = static_cast<Index>(sides_.size());
      sides_.push_back({.body = ContactBody(state, table.body, p.number("stiffness").at(0.0)),
                        .friction = p.number("friction"),
                        .restitution = p.number("restitution"),
                        .young = body.young,
                        .bodies = p.flag("bodies"),
                        .self = p.flag("self"),
                        .young_then = body.young.at(state.time)});
    }
    for (Side& a : sides_)
      for (const Side& b : sides_) a.paired = a.paired || (&a == &b ? a.self : a.bodies && b.bodies);
    for (const Obstacle& obstacle : state.obstacles) obstacles_.emplace_back(obstacle);
  }

  std::string_view name() const override { return "contact"; }
  unsigned needs() const override { return needs_surface; }

  bool near(const State& state) override {
    time_ = state.time;
    for (ObstacleMotion& obstacle : obstacles_) obstacle.move_to(time_);
    for (Side& side : sides_)
      if (side.young_then > 0.0) side.softening = side.young.at(time_) / side.young_then;
    if (searched_ && moved(state) <= slack_) return false;
    search(state);
    searched_ = true;
    return true;
  }

  void mark(const State& state, std::span<std::uint8_t> wanted) const override {
    for (const Candidate& candidate : candidates_) {
      wanted[candidate.vertex] = 1;
      for (const NearSurface& surface : candidate.surfaces)
        for (Index t : surface.triangles)
          for (Index corner : state.surface.triangles[t]) wanted[corner] = 1;
    }
  }

  void surface_force(const State& state, std::span<Vec3> force) override {
    parallel_for_each(
        candidates_.size(), [&](std::size_t k) { answer(state, candidates_[k]); }, 64);
    elapsed_ = 0.0;
    for (Side& side : sides_) side.stiffening = 1.0;
    for (const Candidate& candidate : candidates_) {
      double& stiffening = sides_[candidate.side].stiffening;
      stiffening = std::max(stiffening, candidate.stiffening);
      for (const Answer& answer : candidate.answers) {
        force[candidate.vertex] += answer.force;
        if (answer.triangle == Closest::none) continue;
        const Triangle& t = state.surface.triangles[answer.triangle];
        for (int c = 0; c < 3; ++c) force[t[c]] -= answer.barycentric[c] * answer.force;
        double& other = sides_[side_of_[state.surface.body[t[0]]]].stiffening;
        other = std::max(other, candidate.stiffening);
      }
    }
  }

  void finish(State&, double dt) override {
    elapsed_ += dt;
    last_step_ = dt;
  }

  double energy(const State& state) const override {
    double sum = 0.0;
    std::vector<Contact> contacts;
    for (const Candidate& candidate : candidates_) {
      collect(state, candidate, contacts);
      for (const Contact& contact : contacts) sum += contact.penalty.energy(contact.depth);
      for (const Slip& slip : candidate.slips) sum += slip.energy();
    }
    return sum;
  }

  double stable_step(const State& state) const override {
    double step = infinity, speed = 0.0, length = infinity;
    for (const Side& side : sides_) {
      step = std::min(step, side.stable_step());
      speed = std::max(speed, side.body.speed(state));
      length = std::min(length, side.body.spacing());
    }
    double obstacle_speed = 0.0;
    for (const ObstacleMotion& obstacle : obstacles_) {
      obstacle_speed = std::max(obstacle_speed, obstacle.speed(searched_ ? moved_ : 0.0));
      length = std::min(length, obstacle.thickness());
    }
    speed += obstacle_speed;
    return speed > 0.0 ? std::min(step, travel_per_step * length / speed) : step;
  }

  std::size_t bytes() const override {
    std::size_t sum = points_.capacity() * sizeof(Vec3) + candidates_.capacity() * sizeof(Candidate);
    for (const Side& side : sides_) sum += side.body.bytes();
    for (const Candidate& candidate : candidates_) {
      sum += candidate.slips.capacity() * sizeof(Slip) + candidate.answers.capacity() * sizeof(Answer);
      for (const NearSurface& surface : candidate.surfaces)
        sum += surface.triangles.capacity() * sizeof(Index);
    }
    return sum;
  }

 private:
  // How far a vertex can have moved towards something since the last search.
  double moved(const State& state) {
    moved_ = 0.0;
    for (const Side& side : sides_) moved_ = std::max(moved_, side.body.moved(state));
    double obstacles = 0.0;
    for (const ObstacleMotion& obstacle : obstacles_) obstacles = std::max(obstacles, obstacle.moved(moved_));
    return moved_ + obstacles;
  }

  // Lists anew every vertex that something is near, all vertices being looked at.
  void search(const State& state) {
    std::vector<std::vector<Slip>> slips(state.surface.size());
    for (Candidate& candidate : candidates_) slips[candidate.vertex] = std::move(candidate.slips);
    candidates_.clear();
    points_.resize(state.surface.size());
    deform_surface(state.surface, state.particles, state.fit, state.F, points_);
    slack_ = infinity;
    moved_ = 0.0;
    for (Side& side : sides_) side.body.remember(state);
    remember_obstacles();

    std::vector<std::vector<Index>> obstacles(points_.size());
    search_obstacles(obstacles);
    std::vector<NearSurface> surfaces;
    for (const Side& a : sides_)
      for (const Side& b : sides_) search_surfaces(state, a, b, slips, surfaces);
    std::vector<std::vector<NearSurface>> of_vertex(points_.size());
    for (NearSurface& surface : surfaces) of_vertex[surface.vertex].push_back(std::move(surface));
    for (Index k = 0; k < sides_.size(); ++k) {
      const Range vertices = sides_[k].body.vertices();
      for (Index s = vertices.begin; s < vertices.end; ++s) {
        if (obstacles[s].empty() && of_vertex[s].empty()) continue;
        candidates_.push_back({.vertex = s,
                               .side = k,
                               .obstacles = std::move(obstacles[s]),
                               .surfaces = std::move(of_vertex[s]),
                               .slips = std::move(slips[s])});
      }
    }
  }

  // The ball around all vertices bounds the lever of an obstacle's rotation.
  void remember_obstacles() {
    Vec3 low = Vec3::Constant(infinity), high = -low;
    for (const Side& side : sides_)
      for (Index s = side.body.vertices().begin; s < side.body.vertices().end; ++s) {
        low = low.cwiseMin(points_[s]);
        high = high.cwiseMax(points_[s]);
      }
    for (ObstacleMotion& obstacle : obstacles_)
      obstacle.remember(0.5 * (low + high), 0.5 * (high - low).norm());
  }

  void search_obstacles(std::vector<std::vector<Index>>& near) {
    std::vector<double> far(points_.size(), infinity);
    for (const Side& side : sides_) {
      const Range vertices = side.body.vertices();
      const double margin = search_margin * side.body.spacing();
      parallel_for_each(
          vertices.size(),
          [&](std::size_t k) {
            const Index s = vertices.begin + static_cast<Index>(k);
            for (Index o = 0; o < obstacles_.size(); ++o) {
              const double clearance = obstacles_[o].clearance(points_[s]);
              if (clearance <= margin)
                near[s].push_back(o);
              else
                far[s] = std::min(far[s], clearance);
            }
          },
          64);
    }
    for (const Side& side : sides_) {
      const double shell = Penalty::shell * side.body.spacing();
      for (Index s = side.body.vertices().begin; s < side.body.vertices().end; ++s)
        slack_ = std::min(slack_, far[s] - shell);
    }
  }

  void search_surfaces(const State& state, const Side& a, const Side& b,
                       std::span<const std::vector<Slip>> slips, std::vector<NearSurface>& surfaces) {
    const bool self = &a == &b;
    if (self ? !a.self : !(a.bodies && b.bodies)) return;
    const double spacing = std::min(a.body.spacing(), b.body.spacing());
    const Index partner = partner_of(b);
    const auto touching = [&](Index s) {
      return std::any_of(slips[s].begin(), slips[s].end(),
                         [&](const Slip& slip) { return slip.partner == partner; });
    };
    const double far = find_near_surfaces(
        state, points_, a.body.body(), b.body.body(),
        {deepest * spacing, body_margin * spacing, own_neighborhood * spacing}, touching, surfaces);
    slack_ = std::min(slack_, far);
  }

  Index partner_of(const Side& side) const {
    return static_cast<Index>(obstacles_.size()) + side.body.body();
  }

  // Every contact of a candidate as things stand.
  void collect(const State& state, const Candidate& candidate, std::vector<Contact>& contacts) const {
    contacts.clear();
    const Index s = candidate.vertex;
    const Side& side = sides_[candidate.side];
    const double stiffness = side.softening * side.body.stiffness(s);
    if (!(stiffness > 0.0)) return;
    const Vec3 &point = state.surface.position[s], &velocity = state.surface.velocity[s];
    thread_local std::vector<Touch> touches;
    const double shell = Penalty::shell * side.body.spacing();
    for (Index o : candidate.obstacles) {
      obstacles_[o].find(point, touches, shell);
      for (const Touch& touch : touches)
        contacts.push_back({.partner = o,
                            .depth = touch.depth + shell,
                            .normal = touch.normal,
                            .velocity = velocity - obstacles_[o].velocity_at(point),
                            .penalty = {stiffness, side.body.spacing()},
                            .friction = std::max(side.friction.at(time_), obstacles_[o].friction()),
                            .restitution = side.restitution.at(time_)});
    }
    for (const NearSurface& surface : candidate.surfaces) {
      const Side& other = sides_[side_of_[surface.body]];
      const double spacing = std::min(side.body.spacing(), other.body.spacing());
      const double pair_shell = Penalty::shell * spacing;
      const auto inside = find_penetration(state.surface, surface, deepest * spacing, pair_shell);
      if (!inside) continue;
      const Triangle& t = state.surface.triangles[inside->triangle];
      Vec3 relative = velocity;
      for (int c = 0; c < 3; ++c) relative -= inside->barycentric[c] * state.surface.velocity[t[c]];
      contacts.push_back({.partner = partner_of(other),
                          .depth = inside->depth + pair_shell,
                          .normal = inside->normal,
                          .velocity = relative,
                          .penalty = {pair_stiffness(side, stiffness, other), spacing},
                          .friction = std::max(side.friction.at(time_), other.friction.at(time_)),
                          .restitution = std::min(side.restitution.at(time_), other.restitution.at(time_)),
                          .triangle = inside->triangle,
                          .barycentric = inside->barycentric});
    }
  }

  // Both bodies' vertices act, half each, and no stiffer than what the softer one can take.
  static double pair_stiffness(const Side& side, double stiffness, const Side& other) {
    const double own = side.softening * side.body.per_area(),
                 others = other.softening * other.body.per_area();
    return 0.5 *
           std::min(stiffness * std::min(1.0, others / own), other.softening * other.body.weakest_limit());
  }

  void answer(const State& state, Candidate& candidate) const {
    thread_local std::vector<Contact> contacts;
    collect(state, candidate, contacts);
    candidate.answers.clear();
    candidate.stiffening = 1.0;
    std::vector<Slip> slips;
    const Side& side = sides_[candidate.side];
    const double shared = 1.0 / static_cast<double>(std::max<std::size_t>(contacts.size(), 1));
    for (const Contact& contact : contacts) {
      const double speed = contact.normal.dot(contact.velocity);
      const double ahead = contact.depth + 2.0 * last_step_ * std::max(0.0, -speed);
      candidate.stiffening = std::max(candidate.stiffening, contact.penalty.stiffening_at(ahead));
      const double blend = side.blend() * side.frequency() * contact.penalty.speed(contact.depth);
      const double normal_force =
          contact.penalty.force(contact.depth) * restitution_factor(speed, contact.restitution, blend);
      const Vec3 sliding = contact.velocity - speed * contact.normal;
      Slip slip = take_slip(candidate.slips, contact, sliding);
      slip.stiffness = shared * friction_spring * contact.penalty.stiffness;
      const double damping = shared * friction_damping * contact.penalty.stiffness * 2.0 / side.frequency();
      const Vec3 friction = friction_force(slip, sliding, damping, contact.friction * normal_force);
      candidate.answers.push_back(
          {normal_force * contact.normal + friction, contact.triangle, contact.barycentric});
      slips.push_back(slip);
    }
    candidate.slips = std::move(slips);
  }

  // The spring of the same contact a substep ago, stretched by the motion since, or a new one.
  Slip take_slip(std::span<const Slip> slips, const Contact& contact, const Vec3& sliding) const {
    const Slip* best = nullptr;
    double alike = 0.7;  // of the normals: a container's walls are told apart by them
    for (const Slip& slip : slips) {
      if (slip.partner != contact.partner || slip.normal.dot(contact.normal) <= alike) continue;
      alike = slip.normal.dot(contact.normal);
      best = &slip;
    }
    const Vec3 stretch = best ? Vec3(best->stretch + elapsed_ * sliding) : Vec3(Vec3::Zero());
    return {contact.partner, contact.normal, stretch, 0.0};
  }

  std::vector<Side> sides_;
  std::vector<Index> side_of_;  // of each body, Closest::none without a table
  std::vector<ObstacleMotion> obstacles_;
  std::vector<Candidate> candidates_;  // ascending by side, then vertex
  std::vector<Vec3> points_;           // of the whole surface, at the last search
  bool searched_ = false;
  double slack_ = 0.0;  // how far anything may move before the next search [m]
  double moved_ = 0.0;  // how far vertices have moved since the last [m]
  double time_ = 0.0;
  double elapsed_ = 0.0;    // since the springs of friction were last stretched [s]
  double last_step_ = 0.0;  // [s]
};

}  // namespace

const EffectInfo& contact_effect() {
  static const EffectInfo info = {
      .name = "contact",
      .summary = "keeps the surface out of obstacles and other bodies, with friction and restitution",
      .several = false,
      .in_world = false,
      .settings = settings,
      .make = [](State& state, std::span<const EffectTable> tables) -> std::unique_ptr<Effect> {
        return std::make_unique<ContactEffect>(state, tables);
      }};
  return info;
}

}  // namespace deforma
