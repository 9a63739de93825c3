#include "pipeline/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/files.hpp"
#include "pipeline/user_error.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Scene load_text(const Scratch& scratch, const std::string& text, const std::vector<std::string>& sets = {}) {
  std::vector<Override> overrides;
  for (const std::string& set : sets) overrides.push_back(parse_override(set));
  return load_scene(scratch.write("scene.toml", text), overrides);
}

/// The message with which a scene is refused, without the folder.
std::string refusal(const Scratch& scratch, const std::string& text,
                    const std::vector<std::string>& sets = {}) {
  try {
    load_text(scratch, text, sets);
  } catch (const UserError& error) {
    std::string message = error.what();
    std::string folder = scratch.path().string() + "/";
    for (std::size_t at; (at = message.find(folder)) != message.npos;) message.erase(at, folder.size());
    return message;
  }
  return "accepted";
}

const SceneEffect& effect_of(const std::vector<SceneEffect>& effects, std::string_view name) {
  auto found = std::find_if(effects.begin(), effects.end(),
                            [&](const SceneEffect& e) { return e.info->name == name; });
  if (found == effects.end()) throw std::runtime_error("the scene has no " + std::string(name));
  return *found;
}

bool has(const std::vector<SceneEffect>& effects, std::string_view name) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](const SceneEffect& e) { return e.info->name == name; });
}

TEST(Scene, ReadsWhatItSays) {
  Scratch scratch;
  Scene scene =
      load_text(scratch, small_scene("density = 500\nvelocity = [1, 2, 3]\nlook = { color = \"#ff8000\" }"));
  EXPECT_EQ(scene.name, "scene");
  EXPECT_DOUBLE_EQ(scene.duration, 0.4);
  EXPECT_EQ(scene.frames(), 10);
  EXPECT_EQ(scene.output.width, 320);
  EXPECT_EQ(scene.output.height, 240);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const SceneBody& body = scene.bodies[0];
  EXPECT_EQ(body.name, "box");
  EXPECT_EQ(body.particles, 64);
  EXPECT_DOUBLE_EQ(body.density, 500.0);
  EXPECT_EQ(body.velocity, Vec3(1, 2, 3));
  EXPECT_NEAR((body.look.color - Vec3(1, 128.0 / 255.0, 0)).norm(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(effect_of(body.effects, "elastic").parameters.number("young").at(0), 1e5);
  EXPECT_EQ(effect_of(scene.world, "gravity").parameters.vector("acceleration").at(0), Vec3(0, 0, -9.81));
  ASSERT_TRUE(scene.ground);
  EXPECT_TRUE(scene.ground->solid);
}

TEST(Scene, HasNoGroundUnlessItSaysSo) {
  Scratch scratch;
  std::string text = small_scene();
  text.erase(text.find("[ground]"));
  EXPECT_FALSE(load_text(scratch, text).ground);
}

TEST(Scene, AnElasticBodyGetsHourglassControlUnlessRefused) {
  Scratch scratch;
  EXPECT_TRUE(has(load_text(scratch, small_scene()).bodies[0].effects, "hourglass"));
  Scene without = load_text(scratch, small_scene("hourglass = false"));
  EXPECT_FALSE(has(without.bodies[0].effects, "hourglass"));
  Scene rigid = load_text(scratch, small_scene("elastic = false"));
  EXPECT_FALSE(has(rigid.bodies[0].effects, "hourglass"));
}

TEST(Scene, EffectsAreThoseWithATable) {
  Scratch scratch;
  std::vector<std::string> names;
  Scene scene = load_text(scratch, small_scene("damping = 0.5"));
  for (const SceneEffect& effect : scene.bodies[0].effects) names.emplace_back(effect.info->name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("elastic", "hourglass", "contact", "damping"));
}

TEST(Scene, AValueSetsTheFirstSetting) {
  Scratch scratch;
  Scene scene = load_text(scratch, small_scene("damping = 0.5\ngravity = [1, 0, 0]"));
  EXPECT_DOUBLE_EQ(effect_of(scene.bodies[0].effects, "damping").parameters.number("rate").at(0), 0.5);
  EXPECT_EQ(effect_of(scene.bodies[0].effects, "gravity").parameters.vector("acceleration").at(0),
            Vec3(1, 0, 0));
}

TEST(Scene, SeveralTablesOfOneEffect) {
  Scratch scratch;
  auto several = std::find_if(effect_registry().begin(), effect_registry().end(),
                              [](const EffectInfo& info) { return info.several; });
  ASSERT_NE(several, effect_registry().end());
  std::string name(several->name);
  Scene scene = load_text(scratch, small_scene(name + " = [{}, {}]"));
  EXPECT_EQ(std::count_if(scene.bodies[0].effects.begin(), scene.bodies[0].effects.end(),
                          [&](const SceneEffect& e) { return e.info->name == name; }),
            2);
  EXPECT_THAT(refusal(scratch, small_scene("damping = [{ rate = 1 }, { rate = 2 }]")),
              HasSubstr("scene.toml:13: body.damping: may stand only once, found 2 tables"));
}

TEST(Scene, KeyframesAreToldFromVectors) {
  Scratch scratch;
  Scene scene =
      load_text(scratch, small_scene("elastic = { young = [[0, 1e5], [1, 3e5]] }\n"
                                     "gravity = [[0, [0, 0, -10]], [2, [0, 0, 10]]]",
                                     "[[obstacle]]\nshape = { type = \"sphere\", radius = 0.1 }\n"
                                     "position = [[0, [0, 0, 0]], [1, [1, 0, 0]]]\nrotation = [0, 0, 90]\n"));
  const Curve<double>& young = effect_of(scene.bodies[0].effects, "elastic").parameters.number("young");
  EXPECT_DOUBLE_EQ(young.at(0.5), 2e5);
  EXPECT_NEAR(effect_of(scene.bodies[0].effects, "gravity").parameters.vector("acceleration").at(1).z(), 0.0,
              1e-12);
  EXPECT_DOUBLE_EQ(scene.obstacles[0].position.at(0.25).x(), 0.25);
  EXPECT_FALSE(scene.obstacles[0].rotation.varies());
}

TEST(Scene, NamesAreNumberedUnlessGiven) {
  Scratch scratch;
  std::string second =
      "[[body]]\nshape = { type = \"box\", size = [1, 1, 1] }\nposition = [3, 0, 2]\nparticles = 8\n";
  EXPECT_EQ(load_text(scratch, small_scene("", second)).bodies[1].name, "box_2");
  EXPECT_THAT(refusal(scratch, small_scene("name = \"a\"", second + "name = \"a\"\n")),
              HasSubstr("body.name: 'a' is taken by an earlier body"));
}

TEST(Scene, ResolvedSceneLoadsToTheSameResolvedScene) {
  Scratch scratch;
  scratch.write("tetra.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  std::string text = small_scene(
      "elastic = { young = [[0, 1e5], [1, 3e5]], poisson = 0.1 }\nhourglass = false\ngravity = false\n"
      "damping = 0.3\nvelocity = [0.1, 0.2, 0.3]\nlook = { color = [0.1, 0.2, 0.7], flat = true }",
      "[camera]\nposition = [3, 3, 3]\ntarget = [0, 0, 0.1]\n"
      "[[body]]\nmesh = \"tetra.obj\"\nspacing = 0.25\nposition = [4, 0, 1]\nscale = [1, 2, 3]\nrotation = "
      "[0, 30, 0]\n"
      "[[obstacle]]\nshape = { type = \"box\", size = [1, 1, 1], inside = true }\nposition = [[0, [9, 0, "
      "0]], [1, [9, 1, 0]]]\n"
      "[[obstacle]]\nshape = { type = \"mesh\", file = \"tetra.obj\", scale = 2 }\nposition = [20, 0, 0]\n");
  std::string once = scene_to_toml(load_text(scratch, text));
  std::filesystem::create_directories(scratch / "elsewhere");
  Scene again = load_scene(scratch.write("elsewhere/resolved.toml", once));
  EXPECT_EQ(scene_to_toml(again), once);
  EXPECT_EQ(scene_to_json(again), scene_to_json(load_text(scratch, text)));
  EXPECT_THAT(once, HasSubstr("poisson = 0.1, "));  // the fewest digits that read back the same
  EXPECT_THAT(once, HasSubstr("gravity = false"));
}

TEST(Scene, SetReachesEveryKey) {
  Scratch scratch;
  Scene scene = load_text(
      scratch, small_scene("name = \"duck\""),
      {"duration=1", "body.0.elastic.young=2e5", "body.duck.density=500", "world.gravity=[0,0,-1]",
       "body.0.volume.stiffness=1e6", "output.view=both", "camera.up=[0, 1, 0]", "body.0.position.2=7"});
  EXPECT_DOUBLE_EQ(scene.duration, 1.0);
  EXPECT_DOUBLE_EQ(effect_of(scene.bodies[0].effects, "elastic").parameters.number("young").at(0), 2e5);
  EXPECT_DOUBLE_EQ(effect_of(scene.bodies[0].effects, "volume").parameters.number("stiffness").at(0), 1e6);
  EXPECT_DOUBLE_EQ(scene.bodies[0].density, 500.0);
  EXPECT_DOUBLE_EQ(scene.bodies[0].position.z(), 7.0);
  EXPECT_EQ(effect_of(scene.world, "gravity").parameters.vector("acceleration").at(0), Vec3(0, 0, -1));
  EXPECT_EQ(scene.output.view, "both");
  EXPECT_EQ(scene.camera.up, Vec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(load_text(scratch, small_scene(), {"body.box.density=7"}).bodies[0].density, 7.0);
}

TEST(Scene, EdgesAreAFlagOrAColour) {
  Scratch scratch;
  EXPECT_FALSE(load_text(scratch, small_scene()).bodies[0].look.edges);
  EXPECT_FALSE(load_text(scratch, small_scene(), {"body.0.look.edges=false"}).bodies[0].look.edges);
  EXPECT_TRUE(load_text(scratch, small_scene(), {"body.0.look.edges=true"}).bodies[0].look.edges);
  Scene scene = load_text(scratch, small_scene(), {"body.0.look.edges=[0, 0.5, 1]"});
  EXPECT_EQ(*scene.bodies[0].look.edges, Vec3(0, 0.5, 1));
  EXPECT_THAT(scene_to_toml(scene), HasSubstr("edges = [0.0, 0.5, 1.0]"));
}

TEST(Scene, SetAddsToAnEffectWrittenAsAValue) {
  Scratch scratch;
  Scene scene =
      load_text(scratch, small_scene("elastic = 8e3\ndamping = 2"),
                {"body.0.elastic.poisson=0.4", "body.0.contact.friction=0.9", "body.0.damping.viscosity=5"});
  const Parameters& elastic = effect_of(scene.bodies[0].effects, "elastic").parameters;
  EXPECT_DOUBLE_EQ(elastic.number("young").at(0), 8e3);
  EXPECT_DOUBLE_EQ(elastic.number("poisson").at(0), 0.4);
  EXPECT_DOUBLE_EQ(effect_of(scene.bodies[0].effects, "contact").parameters.number("friction").at(0), 0.9);
  EXPECT_DOUBLE_EQ(effect_of(scene.bodies[0].effects, "damping").parameters.number("rate").at(0), 2.0);
}

TEST(Scene, SetRefusesWhatIsNotThere) {
  Scratch scratch;
  std::string text = small_scene("name = \"duck\"");
  EXPECT_THAT(
      refusal(scratch, text, {"body.0.elastic.youngs=1"}),
      HasSubstr("--set body.0.elastic.youngs=1: body.elastic: unknown key 'youngs'; did you mean 'young'?"));
  EXPECT_THAT(refusal(scratch, text, {"body.0.elastic.young=soft"}), HasSubstr("expected a number"));
  EXPECT_THAT(refusal(scratch, text, {"body.dukc.density=1"}),
              HasSubstr("no element 'dukc'; did you mean 'duck'?"));
  EXPECT_THAT(refusal(scratch, text, {"body.3.density=1"}), HasSubstr("no element 3; the list has 1"));
  EXPECT_THAT(refusal(scratch, text, {"duraton=1"}),
              HasSubstr("--set duraton=1: unknown key 'duraton'; did you mean 'duration'?"));
  EXPECT_THAT(refusal(scratch, text, {"duration.x=1"}), HasSubstr("'duration' is a value, so it has no 'x'"));
  EXPECT_THAT(refusal(scratch, text, {"duration"}), HasSubstr("expected KEY=VALUE"));
  EXPECT_THAT(refusal(scratch, text, {"body..density=1"}), HasSubstr("empty part"));
}

struct Refused {
  std::string text;
  std::string message;
};

TEST(SceneRefuses, WithFileLineKeyAndTheNearestName) {
  Scratch scratch;
  scratch.write("duck.obj", "v 0 0 0\n");
  const std::string no_body = "duration = 1\n";
  const std::vector<Refused> cases = {
      {small_scene("elastic = { youngs = 1 }"),
       "scene.toml:12: body.elastic: unknown key 'youngs'; did you mean 'young'? (allowed: young, poisson, "},
      {small_scene("elastic = { young = 1e5, poisson = 0.5 }"),
       "scene.toml:12: body.elastic.poisson: 0.5 is outside (-1, 0.5)"},
      {small_scene("elastic = { young = 1e5, poisson = nan }"),
       "body.elastic.poisson: nan is outside (-1, 0.5)"},
      {small_scene("elastic = { young = 0 }"), "body.elastic.young: 0 is outside (0, inf)"},
      {small_scene("elastic = { young = inf }"), "body.elastic.young: inf is not finite"},
      {small_scene("elastic = { poisson = 0.3 }"), "body.elastic: missing key 'young'"},
      {small_scene("elastic = true"), "body.elastic: missing key 'young'"},
      {small_scene("elastic = { young = \"soft\" }"),
       "expected a number or keyframes [[time, value], ...], found \"soft\""},
      {small_scene("elastic = { young = [[1, 1e5], [0, 2e5]] }"), "keyframe times must increase"},
      {small_scene("elastic = { young = [1e5, 2e5] }"), "expected a keyframe [time, value], found"},
      {small_scene("elastic = { young = 1e5, material = \"neohookean\" }"), "did you mean 'neo_hookean'?"},
      {small_scene("elastik = { young = 1e5 }"),
       "scene.toml:13: body: unknown key 'elastik'; did you mean 'elastic'?"},
      {small_scene("load = { force = [0, 0, 1], region = { min = [0, 0, 1], max = [1, 1, 0.5] } }"),
       "body.load.region: no z is from min = 1 up to max = 0.5; expected min <= max"},
      {small_scene("gravity = [0, 0]"), "expected [x, y, z] or keyframes"},
      {small_scene("gravity = [0, 0, nan]"), "body.gravity.acceleration: nan is outside (-inf, inf)"},
      {small_scene("density = 0"), "scene.toml:13: body.density: 0 is outside (0, inf)"},
      {small_scene("density = nan"), "body.density: nan is outside (0, inf)"},
      {small_scene("density = inf"), "body.density: inf is not finite"},
      {small_scene("scale = [1, 0, 1]"), "body.scale: [1, 0, 1] is outside (0, inf)"},
      {small_scene("position = [0, 1]"), "scene.toml:13: not valid TOML"},
      {small_scene("rotation = [0, 1]"), "body.rotation: expected three numbers [x, y, z], found [0, 1]"},
      {small_scene("spacing = 0.1"), "expected exactly one of 'particles' and 'spacing', found both"},
      {small_scene("mesh = \"duck.obj\""), "expected exactly one of 'mesh' and 'shape', found both"},
      {small_scene("subdivide = 1\nsurface_particles = 100"),
       "at most one of 'subdivide' and 'surface_particles'"},
      {small_scene("subdivide = 1.5"), "expected a whole number, found 1.5"},
      {small_scene("subdivide = 9"), "body.subdivide: 9 is outside [0, 6]"},
      {small_scene("sampling = \"latice\""),
       "unknown choice 'latice'; did you mean 'lattice'? (allowed: lattice, body_cen"},
      {small_scene("visible = 1"), "expected true or false, found 1"},
      {small_scene("look = { colour = \"#ffffff\" }"),
       "body.look: unknown key 'colour'; did you mean 'color'?"},
      {small_scene("look = { color = \"red\" }"),
       "expected a colour \"#rrggbb\" or [r, g, b] in [0, 1], found 'red'"},
      {small_scene("look = { color = [0, 0, 2] }"), "body.look.color: 2 is outside [0, 1]"},
      {small_scene("look = 3"), "body.look: expected a table, found 3"},
      {small_scene("name = 3"), "expected a text in quotes, found 3"},
      {small_scene("", "[[obstacle]]\nshape = { type = \"cone\" }"),
       "obstacle.shape.type: unknown choice 'cone'"},
      {small_scene("", "[[obstacle]]\nshape = { radius = 1 }"),
       "obstacle.shape: missing key 'type' (one of plane, "},
      {small_scene("", "[[obstacle]]\nfriction = 1"), "obstacle: missing key 'shape'"},
      {small_scene("", "[[obstacle]]\nshape = { type = \"sphere\", radius = -1 }"),
       "shape.radius: -1 is outside (0, inf)"},
      {small_scene("", "[[obstacle]]\nshape = { type = \"box\", size = [1, 0, 1] }"),
       "three lengths above 0 m"},
      {small_scene("", "[[obstacle]]\nshape = { type = \"plane\", normal = [0, 0, 0] }"),
       "shape.normal: expected any direction"},
      {small_scene("", "[[obstacle]]\nshape = { type = \"mesh\", file = \"ducl.obj\" }"),
       "did you mean 'duck.obj'?"},
      {small_scene("", "[camera]\nfield_of_view = 0"), "camera.field_of_view: 0 is outside (1, 170)"},
      {small_scene("", "[camera]\nfov = 30"), "camera: unknown key 'fov'"},
      {small_scene("", "[solver]\nneighbors = 2"), "solver.neighbors: 2 is outside [3, "},
      {small_scene("", "[solver]\nkernel = \"cubic\""), "unknown choice 'cubic'"},
      {small_scene("", "[solver]\nkernel = 6"), "found 6 (allowed: poly6, "},
      {small_scene("", "[solver]\nstep_fraction = 0"), "solver.step_fraction: 0 is outside (0, 1]"},
      {small_scene("", "[light]\nintensity = -1"), "light.intensity: -1 is outside [0, inf)"},
      {"duration = 0\n[[body]]\n", "scene.toml:1: duration: 0 is outside (0, inf)"},
      {"duration = -1\n[[body]]\n", "duration: -1 is outside (0, inf)"},
      {"duration = 1\nfps = 0\n[[body]]\n", "scene.toml:2: fps: 0 is outside (0, 1000]"},
      {"duration = 1e9\n[[body]]\n", "more than a million frames"},
      {"duraton = 1\n[[body]]\n", "scene.toml:1: unknown key 'duraton'; did you mean 'duration'?"},
      {"[[body]]\n", "missing key 'duration'"},
      {no_body, "no [[body]]: a scene needs at least one"},
      {no_body + "body = 3\n", "expected [[body]] tables, found 3"},
      {no_body + "[output]\nsize = [0, 240]\n[[body]]\n", "output.size: 0 pixels is outside [1, "},
      {no_body + "[output]\nsize = 3\n[[body]]\n", "expected two whole numbers [width, height], found 3"},
      {no_body + "[output]\nvideo = \"mpeg\"\n[[body]]\n", "unknown choice 'mpeg'; did you mean 'mp4'?"},
      {no_body + "[[body]]\nmesh = \"dukc.obj\"\nparticles = 9\n",
       "scene.toml:3: body.mesh: no such file 'dukc.obj' (looked for dukc.obj and among the installed "
       "meshes); did you "
       "mean 'duck.obj'?"},
      {no_body + "[[body]]\nmesh = \".\"\nparticles = 9\n",
       "body.mesh: '.' is a folder; expected a mesh file"},
      {no_body + "[camera]\nheight = 2\n[[body]]\n",
       "scene.toml:3: camera.height: counts only with projection = \"orthographic\", found \"perspective\""},
      {no_body + "[[body]]\nparticles = 9\nlook = { edges = 1 }\n",
       "scene.toml:4: body.look.edges: expected true, false or a colour \"#rrggbb\" or [r, g, b] in [0, 1], "
       "found 1"},
      {no_body + "[[body]]\nparticles = 9\n", "expected exactly one of 'mesh' and 'shape', found none"},
      {no_body + "[[body]]\nshape = { type = \"box\", size = [1, 1, 1] }\n",
       "'particles' and 'spacing', found none"},
      {no_body + "[[body]]\nparticles = 0\n", "body.particles: 0 is outside [1, "},
      {no_body + "[[body]]\nshape = { type = \"cylindr\" }\n", "did you mean 'cylinder'?"},
      {no_body + "[[body]]\nshape = { type = \"sphere\" }\n", "body.shape: missing key 'radius' (radius, m)"},
      {no_body + "[world]\nelastic = { young = 1e5 }\n[[body]]\n", "world: unknown key 'elastic'"},
      {no_body + "[[body]\n", "scene.toml:2: not valid TOML"},
      {"", "scene.toml: cannot be read, or is empty"},
  };
  for (const Refused& refused : cases) {
    EXPECT_THAT(refusal(scratch, refused.text), HasSubstr(refused.message)) << refused.text;
  }
}

TEST(Files, AShippedSceneIsFoundByItsName) {
  std::filesystem::path scenes = assets_folder() / "scenes";
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_EQ(find_scene(entry.path().stem().string()), entry.path());
    ++found;
  }
  EXPECT_EQ(found == 0, std::filesystem::is_empty(scenes));
}

TEST(Files, AMissingSceneIsToldWithTheNearestName) {
  Scratch scratch;
  scratch.write("falling.toml", "");
  try {
    find_scene((scratch / "faling.toml").string());
    FAIL() << "found";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no such scene file; did you mean 'falling.toml'?"));
  }
  try {
    find_scene(scratch.path().string());
    FAIL() << "found";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is a folder"));
  }
}

}  // namespace
}  // namespace deforma
