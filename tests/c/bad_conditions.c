/* Bad input to tables, prescribed velocities, tractions, settling and initial stresses: an error before the first step, with a
 * message that says what to do, and the world is what it was. Argument: the elastic plugin. */
#include "check.h"

static lahar_context *context;
static lahar_material *material;
static lahar_world *world;
static int64_t body;

#define INVALID(call, part) REFUSED(world, call, LAHAR_ERROR_INVALID_ARGUMENT, part)

static void bad_tables(void) {
  const double backwards[3] = {0, 2, 1}, twice[2] = {1, 1}, with_nan[2] = {0, NAN}, good[2] = {0, 1};
  const double values[9] = {0}, infinite[6] = {0, 0, 0, 0, INFINITY, 0}, in_z[6] = {0, 0, NAN, 0, 0, NAN};
  INVALID(lahar_world_set_gravity_table(world, 0, good, values), "needs at least one row");
  INVALID(lahar_world_set_gravity_table(world, -1, good, values), "`count` is -1");
  INVALID(lahar_world_set_gravity_table(world, 3, backwards, values), "row 2 has 1 s after 2 s, so that what begins in row 1 would end before it begins");
  INVALID(lahar_world_set_gravity_table(world, 2, twice, values), "row 1 has 1 s after 1 s");
  INVALID(lahar_world_set_gravity_table(world, 2, with_nan, values), "row 1 of the table of gravity must be finite");
  INVALID(lahar_world_set_gravity_table(world, 2, good, infinite), "row 1 of the table of gravity must be finite");
  INVALID(lahar_world_set_gravity_table(world, INT64_MAX, good, values), "more than memory can hold");
  OK(lahar_world_set_gravity_table(world, 2, good, in_z)); /* the third component is ignored in two dimensions */
  OK(lahar_world_set_gravity(world, values));
}

static lahar_prescribed_velocity good_velocity(void) {
  lahar_prescribed_velocity c;
  int d;
  OK(lahar_prescribed_velocity_init(&c, sizeof c));
  c.components = LAHAR_COMPONENT_X;
  for (d = 0; d < 3; ++d) c.box_min[d] = 0, c.box_max[d] = 1;
  return c;
}

static void bad_prescribed_velocities(void) {
  const double times[2] = {1, 0}, values[6] = {0};
  int64_t id = -1;
  double force[3];
  lahar_prescribed_velocity c = good_velocity();
  c.components = 0;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "components must be the sum of 1 (x), 2 (y), in two dimensions without z");
  c.components = LAHAR_COMPONENT_Z;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "got 4");
  c = good_velocity();
  c.box_min[1] = 2;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "along y they are 2 and 1");
  OK(lahar_prescribed_velocity_init(&c, sizeof c));
  c.components = LAHAR_COMPONENT_X;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "the box of a prescribed velocity was not set along x: give its corners");
  for (int d = 0; d < 3; ++d) c.box_min[d] = 0;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "needs min <= max, neither being NaN");
  c = good_velocity();
  c.velocity[0] = NAN;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "row 0 of the table of a prescribed velocity must be finite");
  c = good_velocity();
  c.table.count = 2;
  REFUSED(world, lahar_prescribed_velocity_add(world, &c, &id), LAHAR_ERROR_NULL_ARGUMENT, "`times` is NULL");
  c.table.times = times;
  REFUSED(world, lahar_prescribed_velocity_add(world, &c, &id), LAHAR_ERROR_NULL_ARGUMENT, "`values` is NULL");
  c.table.values = values;
  INVALID(lahar_prescribed_velocity_add(world, &c, &id), "the times of the table of a prescribed velocity must increase");
  c.struct_size = 8;
  REFUSED(world, lahar_prescribed_velocity_add(world, &c, &id), LAHAR_ERROR_STRUCT_SIZE, "which is 104");
  REFUSED(world, lahar_prescribed_velocity_remove(world, 7), LAHAR_ERROR_NOT_FOUND, "no prescribed velocity has the id 7");
  REFUSED(world, lahar_prescribed_velocity_reaction(world, 7, force), LAHAR_ERROR_NOT_FOUND, "(known: there is none)");
  CHECK(id == -1);
  c = good_velocity();
  OK(lahar_prescribed_velocity_add(world, &c, &id));
  CHECK(id == 0);
  OK(lahar_prescribed_velocity_remove(world, id));
  OK(lahar_prescribed_velocity_add(world, &c, &id));
  CHECK(id == 1); /* ids are not used again */
  OK(lahar_prescribed_velocity_remove(world, id));
}

/* A load on the upper side of the block of 1 m x 1 m, whose particles are 0.05 m wide. */
static lahar_traction good_traction(void) {
  lahar_traction t;
  OK(lahar_traction_init(&t, sizeof t));
  t.body = body;
  t.axis = 1;
  t.box_min[0] = 0, t.box_max[0] = 1;
  t.box_min[1] = 0.95, t.box_max[1] = 1;
  t.traction[1] = -100;
  return t;
}

static void bad_tractions(void) {
  const double times[2] = {1, 0}, factors[2] = {0, 1}, x[4] = {2, 0.5, 2.1, 0.5}, volumes[2] = {0.01, 0.01};
  int64_t id = -1, points = -1, count = 0;
  double force[3], area = 0;
  lahar_particles particles;
  lahar_traction t = good_traction();
  t.body = 9;
  REFUSED(world, lahar_traction_add(world, &t, &id), LAHAR_ERROR_NOT_FOUND, "no body has the id 9");
  t = good_traction();
  t.axis = 2;
  INVALID(lahar_traction_add(world, &t, &id), "axis of a traction's normal must be 0 to 1");
  t = good_traction();
  for (int d = 0; d < 3; ++d) t.box_min[d] = t.box_max[d] = NAN; /* as lahar_traction_init leaves them */
  INVALID(lahar_traction_add(world, &t, &id), "the box of a traction was not set along x: give its corners box_min and box_max");
  t.axis = -1;
  INVALID(lahar_traction_add(world, &t, &id), "`axis` is -1");
  t = good_traction();
  t.side = 0;
  INVALID(lahar_traction_add(world, &t, &id), "side of a traction must be 1");
  t = good_traction();
  t.reserved = 1;
  INVALID(lahar_traction_add(world, &t, &id), "`reserved`");
  t = good_traction();
  t.box_max[1] = NAN;
  INVALID(lahar_traction_add(world, &t, &id), "the box of a traction needs min <= max");
  t = good_traction();
  t.box_min[1] = 1.5, t.box_max[1] = 2;
  INVALID(lahar_traction_add(world, &t, &id), "holds the centre of no particle of body 0: it must hold the outermost layer");
  t = good_traction();
  t.box_min[1] = 0.9;
  INVALID(lahar_traction_add(world, &t, &id), "behind one another along the normal");
  t = good_traction();
  t.traction[0] = INFINITY;
  INVALID(lahar_traction_add(world, &t, &id), "table of a traction must be finite");
  t = good_traction();
  t.factors.count = 2;
  t.factors.times = times;
  t.factors.values = factors;
  INVALID(lahar_traction_add(world, &t, &id), "row 1 has 0 s after 1 s");
  /* a body without a surface: its particles have no known edge lengths */
  OK(lahar_particles_init(&particles, sizeof particles));
  particles.count = 2;
  particles.density = 1000;
  particles.position.data = x;
  particles.volume.data = volumes;
  OK(lahar_body_add_particles(world, material, &particles, &points));
  t = good_traction();
  t.body = points;
  t.box_max[0] = 3, t.box_min[1] = 0;
  INVALID(lahar_traction_add(world, &t, &id), "a traction needs a surface, and the particles of body 1 have no known edge lengths: give `size`");
  CHECK(id == -1);
  OK(lahar_body_remove(world, points));
  /* a load goes with its body */
  points = add_block(world, material, 1000);
  t = good_traction();
  t.body = points;
  OK(lahar_traction_add(world, &t, &id));
  OK(lahar_traction_force(world, id, &count, &area, force));
  CHECK(count == 20 && fabs(area - 1) < 1e-12 && force[1] == 0);
  OK(lahar_body_remove(world, points));
  REFUSED(world, lahar_traction_force(world, id, &count, &area, force), LAHAR_ERROR_NOT_FOUND, "no traction has the id 0");
  REFUSED(world, lahar_traction_remove(world, id), LAHAR_ERROR_NOT_FOUND, "no traction has the id 0");
}

static void bad_settling(void) {
  lahar_settle_criteria c;
  lahar_settle_result result = {0};
  lahar_world *empty = NULL;
  lahar_world_options options;
  result.struct_size = sizeof result;
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.kinetic_ratio = 0;
  INVALID(lahar_world_settle(world, &c, &result), "must be positive and finite, got 0 and 0.001");
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.unbalanced_ratio = NAN;
  INVALID(lahar_world_settle(world, &c, &result), "must be positive and finite");
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.max_steps = 0;
  INVALID(lahar_world_settle(world, &c, &result), "max_steps >= 1");
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.until = 0;
  INVALID(lahar_world_settle(world, &c, &result), "`until` after now");
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.reserved = 1;
  INVALID(lahar_world_settle(world, &c, &result), "`reserved`");
  CHECK(result.steps == 0 && result.converged == 0);
  OK(lahar_world_options_init(&options, sizeof options));
  options.spacing = 1;
  OK(lahar_world_create(context, &options, &empty));
  EXPECT(lahar_world_settle(empty, NULL, &result), LAHAR_ERROR_INVALID_ARGUMENT, "nothing can settle");
  lahar_world_free(empty);
  /* not settled in time is no error */
  OK(lahar_settle_criteria_init(&c, sizeof c));
  c.max_steps = 60;
  OK(lahar_world_settle(world, &c, &result));
  CHECK(result.converged == 0 && result.steps == 60 && result.time > 0 && result.unbalanced_ratio > 1e-3);
}

static void bad_initial_stress(void) {
  const double none[3] = {0, 0, 0}, oblique[3] = {1, -9, 0}, down[3] = {0, -9.81, 0};
  OK(lahar_world_set_gravity(world, none));
  INVALID(lahar_body_set_k0_stress(world, body, 1, 0, 0.5), "needs gravity along one axis at the present time");
  OK(lahar_world_set_gravity(world, oblique));
  INVALID(lahar_body_set_k0_stress(world, body, 1, 0, 0.5), "needs gravity along one axis");
  OK(lahar_world_set_gravity(world, down));
  INVALID(lahar_body_set_k0_stress(world, body, NAN, 0, 0.5), "surface_level must be finite");
  INVALID(lahar_body_set_k0_stress(world, body, 1, 0, -0.5), "k0 finite and not negative");
  INVALID(lahar_body_set_k0_stress(world, body, 1, -1, 0.5), "unit_weight must be positive");
  REFUSED(world, lahar_body_set_k0_stress(world, 5, 1, 0, 0.5), LAHAR_ERROR_NOT_FOUND, "no body has the id 5");
  REFUSED(world, lahar_body_init_state(world, 5), LAHAR_ERROR_NOT_FOUND, "no body has the id 5");
}

int main(int argc, char **argv) {
  if (argc < 2) return 2;
  context = make_context((const char *const[]){argv[1], NULL});
  material = make_elastic(context);
  world = make_world(context);
  if (failures) return 1;
  body = add_block(world, material, 1000);
  bad_tables();
  bad_prescribed_velocities();
  bad_tractions();
  bad_initial_stress();
  bad_settling();
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures != 0;
}
