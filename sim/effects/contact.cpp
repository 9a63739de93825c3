#include "sim/effects/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/contact_law.hpp"
#include "sim/contact_properties.hpp"
#include "sim/contact_search.hpp"
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
     .meaning = "of the contact alone: speed after over before for a body without elastic; the smaller of "
                "two counts",
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

constexpr double travel_per_step = 0.35;  // spacings, so that nothing passes a surface unseen
constexpr double foresight = 0.4;         // spacings: how far ahead of it a vertex sees a surface

constexpr double friction_spring = 0.5;    // of the normal one: the sum over a corner's walls stays in bounds
constexpr double friction_damping = 0.25;  // of the stable step: the time constant of damper over spring

// One vertex touching one thing.
struct Contact {
  Index partner;  // an obstacle's number, or the count of obstacles plus a body's
  double depth;   // of the vertex beyond the surface itself, negative outside
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

// A vertex that something is near, and what became of it this substep.
struct Candidate {
  NearVertex near;
  std::vector<Slip> slips;
  std::vector<Answer> answers = {};
  double stiffening = 1.0;
  double arrival = infinity;  // until it is where contact begins [s]
  double passage = infinity;  // for the way from there to where the spring is much stiffer [s]
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
                        .young_then = body.young.at(state.time)});
    }
    for (const EffectTable& table : tables)
      search_.push_back({table.body, table.parameters.flag("bodies"), table.parameters.flag("self")});
    for (std::size_t a = 0; a < search_.size(); ++a)
      for (std::size_t b = 0; b < search_.size(); ++b)
        sides_[a].paired =
            sides_[a].paired || (a == b ? search_[a].self : search_[a].bodies && search_[b].bodies);
    for (const Obstacle& obstacle : state.obstacles) obstacles_.emplace_back(obstacle);
    full_shells_.assign(state.surface.size(), 0.0);
    for (const ContactProperties& side : sides_)
      for (Index s = side.body.vertices().begin; s < side.body.vertices().end; ++s)
        full_shells_[s] = Penalty::shell * side.body.spacing();
  }

  std::string_view name() const override { return "contact"; }
  unsigned needs() const override { return needs_surface; }

  bool near(const State& state) override {
    time_ = state.time;
    for (ObstacleMotion& obstacle : obstacles_) obstacle.move_to(time_);
    for (ContactProperties& side : sides_) side.move_to(time_);
    if (searched_ && moved(state) <= 0.5 * slack_) return false;
    search(state);
    searched_ = true;
    return true;
  }

  void mark(const State& state, std::span<std::uint8_t> wanted) const override {
    for (const Candidate& candidate : candidates_) {
      wanted[candidate.near.vertex] = 1;
      for (const NearSurface& surface : candidate.near.surfaces)
        for (Index t : surface.triangles)
          for (Index corner : state.surface.triangles[t]) wanted[corner] = 1;
    }
  }

  void surface_force(const State& state, std::span<Vec3> force) override {
    parallel_for_each(
        candidates_.size(), [&](std::size_t k) { answer(state, candidates_[k]); }, 64);
    elapsed_ = 0.0;
    for (ContactProperties& side : sides_) side.stiffening = 1.0;
    for (const Candidate& candidate : candidates_) {
      double& stiffening = sides_[candidate.near.side].stiffening;
      stiffening = std::max(stiffening, candidate.stiffening);
      for (const Answer& answer : candidate.answers) {
        force[candidate.near.vertex] += answer.force;
        if (answer.triangle == Closest::none) continue;
        const Triangle& t = state.surface.triangles[answer.triangle];
        for (int c = 0; c < 3; ++c) force[t[c]] -= answer.barycentric[c] * answer.force;
        double& other = sides_[side_of_[state.surface.body[t[0]]]].stiffening;
        other = std::max(other, candidate.stiffening);
      }
    }
  }

  // The skin can stand still while particles are driven through it: they are kept out themselves, without friction.
  void force(const State& state, std::span<Vec3> force) override {
    std::vector<Touch> touches;
    for (const NearParticle& near : particles_) {
      const Vec3 x = state.particles.position(near.particle);
      ContactProperties& side = sides_[near.side];
      const Penalty penalty = particle_penalty(state, near);
      for (Index o : near.obstacles) {
        obstacles_[o].find(x, touches, 0.0);
        for (const Touch& touch : touches) {
          const double speed =
              touch.normal.dot(state.particles.velocity[near.particle] - obstacles_[o].velocity_at(x));
          const double blend = side.blend() * side.frequency() * penalty.speed(touch.depth);
          force[near.particle] += penalty.force(touch.depth) *
                                  restitution_factor(speed, side.restitution.at(time_), blend) * touch.normal;
          side.stiffening = std::max(side.stiffening, stiffening_ahead(penalty, touch.depth, speed));
        }
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
      for (const Contact& contact : contacts)
        sum += contact.penalty.energy(std::max(0.0, compression(candidate, contact)));
      for (const Slip& slip : candidate.slips) sum += slip.energy();
    }
    std::vector<Touch> touches;
    for (const NearParticle& near : particles_)
      for (Index o : near.obstacles) {
        obstacles_[o].find(state.particles.position(near.particle), touches, 0.0);
        for (const Touch& touch : touches) sum += particle_penalty(state, near).energy(touch.depth);
      }
    return sum;
  }

  double stable_step(const State& state) const override {
    double step = infinity, speed = 0.0, length = infinity;
    for (const ContactProperties& side : sides_) {
      step = std::min(step, side.stable_step());
      speed = std::max(speed, side.body.speed(state));
      length = std::min(length, side.body.spacing());
    }
    // What arrives must not find itself deep inside at once: that would give it energy.
    for (const Candidate& candidate : candidates_)
      step = std::min(step, std::max(candidate.arrival - last_step_, 0.0) + candidate.passage);
    double obstacle_speed = 0.0;
    for (const ObstacleMotion& obstacle : obstacles_) {
      obstacle_speed = std::max(obstacle_speed, obstacle.speed(searched_ ? moved_ : 0.0));
      length = std::min(length, obstacle.thickness());
    }
    speed += obstacle_speed;
    return speed > 0.0 ? std::min(step, travel_per_step * length / speed) : step;
  }

  bool driven(double from, double to) const override {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [&](const ObstacleMotion& obstacle) { return obstacle.varies(from, to); });
  }

  std::size_t bytes() const override {
    std::size_t sum = points_.capacity() * sizeof(Vec3) + candidates_.capacity() * sizeof(Candidate);
    for (const ContactProperties& side : sides_) sum += side.body.bytes();
    for (const Candidate& candidate : candidates_) {
      sum += candidate.slips.capacity() * sizeof(Slip) + candidate.answers.capacity() * sizeof(Answer);
      for (const NearSurface& surface : candidate.near.surfaces)
        sum += surface.triangles.capacity() * sizeof(Index);
    }
    return sum;
  }

 private:
  // How far a vertex can have moved towards something since the last search.
  double moved(const State& state) {
    moved_ = 0.0;
    for (const ContactProperties& side : sides_) moved_ = std::max(moved_, side.body.moved(state));
    double obstacles = 0.0;
    for (const ObstacleMotion& obstacle : obstacles_) obstacles = std::max(obstacles, obstacle.moved(moved_));
    return moved_ + obstacles;
  }

  // Lists anew every vertex and particle that something is near, all of them being looked at.
  void search(const State& state) {
    std::vector<std::vector<Slip>> slips(state.surface.size());
    for (Candidate& candidate : candidates_) slips[candidate.near.vertex] = std::move(candidate.slips);
    points_.resize(state.surface.size());
    deform_surface(state.surface, state.particles, state.fit, state.F, points_);
    for (ContactProperties& side : sides_) side.body.remember(state);
    remember_obstacles();
    moved_ = 0.0;

    const auto touching_itself = [&](Index s) {
      return std::any_of(slips[s].begin(), slips[s].end(), [&](const Slip& slip) {
        return slip.partner == obstacles_.size() + state.surface.body[s];
      });
    };
    ContactPlaces places = find_contact_places(state, points_, search_, obstacles_, touching_itself);
    slack_ = places.slack;
    particles_ = std::move(places.particles);
    const std::vector<double> before = std::exchange(shells_, full_shells_);
    candidates_.clear();
    for (NearVertex& near : places.vertices) {
      const Index s = near.vertex;
      shells_[s] = before.empty() ? 0.0 : before[s];
      candidates_.push_back({std::move(near), std::move(slips[s])});
    }
  }

  // The ball around all vertices bounds the lever of an obstacle's rotation.
  void remember_obstacles() {
    Vec3 low = Vec3::Constant(infinity), high = -low;
    for (const ContactProperties& side : sides_)
      for (Index s = side.body.vertices().begin; s < side.body.vertices().end; ++s) {
        low = low.cwiseMin(points_[s]);
        high = high.cwiseMax(points_[s]);
      }
    for (ObstacleMotion& obstacle : obstacles_)
      obstacle.remember(0.5 * (low + high), 0.5 * (high - low).norm());
  }

  Index partner_of(const ContactProperties& side) const {
    return static_cast<Index>(obstacles_.size()) + side.body.body();
  }

  Penalty particle_penalty(const State& state, const NearParticle& near) const {
    const ContactProperties& side = sides_[near.side];
    const double frequency = side.frequency();
    return {0.5 * state.particles.mass[near.particle] * frequency * frequency, side.body.spacing()};
  }

  // A step is chosen before it is known where it leads: what the spring will be then.
  double stiffening_ahead(const Penalty& penalty, double depth, double speed) const {
    return penalty.stiffening_at(depth + 2.0 * last_step_ * std::max(0.0, -speed));
  }

  // Every contact of a candidate as things stand, and those to come: their depth is negative.
  void collect(const State& state, const Candidate& candidate, std::vector<Contact>& contacts) const {
    contacts.clear();
    const Index s = candidate.near.vertex;
    const ContactProperties& side = sides_[candidate.near.side];
    const double stiffness = side.softening * side.body.stiffness(s);
    if (!(stiffness > 0.0)) return;
    const Vec3 &point = state.surface.position[s], &velocity = state.surface.velocity[s];
    thread_local std::vector<Touch> touches;
    const double reach = (Penalty::shell + foresight) * side.body.spacing();
    for (Index o : candidate.near.obstacles) {
      obstacles_[o].find(point, touches, reach);
      for (const Touch& touch : touches)
        contacts.push_back({.partner = o,
                            .depth = touch.depth,
                            .normal = touch.normal,
                            .velocity = velocity - obstacles_[o].velocity_at(point),
                            .penalty = {stiffness, side.body.spacing()},
                            .friction = std::max(side.friction.at(time_), obstacles_[o].friction()),
                            .restitution = side.restitution.at(time_)});
    }
    for (const NearSurface& surface : candidate.near.surfaces) {
      const ContactProperties& other = sides_[side_of_[surface.body]];
      const double spacing = std::min(side.body.spacing(), other.body.spacing());
      const auto inside = find_penetration(state.surface, surface, deepest_contact * spacing,
                                           (Penalty::shell + foresight) * spacing);
      if (!inside) continue;
      const Triangle& t = state.surface.triangles[inside->triangle];
      Vec3 relative = velocity;
      for (int c = 0; c < 3; ++c) relative -= inside->barycentric[c] * state.surface.velocity[t[c]];
      contacts.push_back({.partner = partner_of(other),
                          .depth = inside->depth,
                          .normal = inside->normal,
                          .velocity = relative,
                          .penalty = {pair_stiffness(side, stiffness, other), spacing},
                          .friction = std::max(side.friction.at(time_), other.friction.at(time_)),
                          .restitution = std::min(side.restitution.at(time_), other.restitution.at(time_)),
                          .triangle = inside->triangle,
                          .barycentric = inside->barycentric});
    }
  }

  // How far a contact's spring is compressed [m]. It begins outside the surface, but for a vertex that has been too close
  // from the start only as far out as it ever was: what is put on the floor is not thrown off it.
  double compression(const Candidate& candidate, const Contact& contact) const {
    return contact.depth + std::min(shells_[candidate.near.vertex], Penalty::shell * contact.penalty.spacing);
  }

  void answer(const State& state, Candidate& candidate) {
    thread_local std::vector<Contact> contacts;
    collect(state, candidate, contacts);
    candidate.answers.clear();
    candidate.stiffening = 1.0;
    candidate.arrival = candidate.passage = infinity;
    std::vector<Slip> slips;
    const ContactProperties& side = sides_[candidate.near.side];
    double gap = infinity;
    for (const Contact& contact : contacts) gap = std::min(gap, -contact.depth);
    double& shell = shells_[candidate.near.vertex];
    shell = std::max(shell, std::min(gap, Penalty::shell * side.body.spacing()));
    for (Contact& contact : contacts) {
      contact.depth = compression(candidate, contact);
      const double approach = -contact.normal.dot(contact.velocity);
      if (contact.depth > 0.0 || approach <= 0.0 || -contact.depth / approach > candidate.arrival) continue;
      candidate.arrival = -contact.depth / approach;
      candidate.passage = Penalty::stiffening * contact.penalty.spacing / approach;
    }
    std::erase_if(contacts, [](const Contact& contact) { return contact.depth <= 0.0; });
    const double shared = 1.0 / static_cast<double>(std::max<std::size_t>(contacts.size(), 1));
    for (const Contact& contact : contacts) {
      const double speed = contact.normal.dot(contact.velocity);
      candidate.stiffening =
          std::max(candidate.stiffening, stiffening_ahead(contact.penalty, contact.depth, speed));
      const double blend = side.blend() * side.frequency() * contact.penalty.speed(contact.depth);
      const double normal_force =
          contact.penalty.force(contact.depth) * restitution_factor(speed, contact.restitution, blend);
      const Vec3 sliding = contact.velocity - speed * contact.normal;
      Slip slip = take_slip(candidate.slips, contact.partner, contact.normal);
      slip.stretch += elapsed_ * sliding;
      slip.stiffness = shared * friction_spring * contact.penalty.stiffness;
      const double damping = shared * friction_damping * contact.penalty.stiffness * 2.0 / side.frequency();
      const Vec3 friction = friction_force(slip, sliding, damping, contact.friction * normal_force);
      candidate.answers.push_back(
          {normal_force * contact.normal + friction, contact.triangle, contact.barycentric});
      slips.push_back(slip);
    }
    candidate.slips = std::move(slips);
  }

  std::vector<ContactProperties> sides_;
  std::vector<Index> side_of_;       // of each body, Closest::none without a table
  std::vector<ContactSide> search_;  // beside `sides_`
  std::vector<ObstacleMotion> obstacles_;
  std::vector<Candidate> candidates_;    // ascending by side, then vertex
  std::vector<NearParticle> particles_;  // near obstacles
  std::vector<double> shells_;           // how far outside contact begins, per vertex [m]
  std::vector<double> full_shells_;      // where nothing was near at the start
  std::vector<Vec3> points_;             // of the whole surface, at the last search
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
