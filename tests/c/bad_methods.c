/* Choices of the method that are wrong, do not go together, or lack what they need: an error before the first step, with the nearest choice that
 * works. Argument: the elastic plugin. */
#include "check.h"

static lahar_context *context;
static lahar_material *material;
static lahar_world *world;

/* A world of one option that is wrong, or of two that do not go together. */
static void refuse_method(int32_t *which, int32_t value, int32_t *other, int32_t other_value, lahar_world_options *options,
                          lahar_status status, const char *part) {
  lahar_world *made = world;
  OK(lahar_world_options_init(options, sizeof *options));
  options->spacing = 0.1;
  *which = value;
  if (other != NULL) *other = other_value;
  EXPECT(lahar_world_create(context, options, &made), status, part);
  CHECK(made == NULL);
}

static void bad_methods(void) {
  double position[2] = {0.05, 0.05}, volume[1] = {1e-2}, size[2] = {0.1, -0.1};
  lahar_world_options o;
  lahar_particles particles;
  lahar_world *made = NULL;
  lahar_wall wall;
  int64_t id;
  refuse_method(&o.transfer, LAHAR_TRANSFER_MLS, &o.shape, LAHAR_SHAPE_LINEAR, &o, LAHAR_ERROR_UNSUPPORTED, "for linear shape functions");
  refuse_method(&o.transfer, LAHAR_TRANSFER_MLS, &o.shape, LAHAR_SHAPE_UNIFORM_GIMP, &o, LAHAR_ERROR_UNSUPPORTED, "quadratic or cubic B-spline");
  refuse_method(&o.axisymmetric, 1, NULL, 0, &o, LAHAR_ERROR_UNSUPPORTED, "needs dimension 2");
  refuse_method(&o.axisymmetric, 2, NULL, 0, &o, LAHAR_ERROR_INVALID_ARGUMENT, "`axisymmetric` is 2");
  refuse_method(&o.body_force, -1, NULL, 0, &o, LAHAR_ERROR_INVALID_ARGUMENT, "`body_force` is -1");
  refuse_method(&o.wall_treatment, 7, NULL, 0, &o, LAHAR_ERROR_INVALID_ARGUMENT, "wall_treatment must be 0");
  refuse_method(&o.filter_order, 21, NULL, 0, &o, LAHAR_ERROR_INVALID_ARGUMENT, "filter_order must be 1 (PIC) to 20");
  refuse_method(&o.filter_order, -1, NULL, 0, &o, LAHAR_ERROR_INVALID_ARGUMENT, "filter_order must be 1 (PIC) to 20");
  OK(lahar_world_options_init(&o, sizeof o));
  o.spacing = 0.1;
  o.pic_rate = -1.0;
  EXPECT(lahar_world_create(context, &o, &made), LAHAR_ERROR_INVALID_ARGUMENT, "pic_rate must be 0");

  /* What two dimensions ignore, and the default filter. */
  OK(lahar_world_options_init(&o, sizeof o));
  o.spacing = 0.1;
  o.transfer = LAHAR_TRANSFER_XPIC;
  o.filter_order = 0;
  o.origin[2] = NAN;
  o.gravity[2] = INFINITY;
  EXPECT(lahar_world_create(context, &o, &made), LAHAR_ERROR_INVALID_ARGUMENT, "origin must be finite");
  o.dimension = 2;
  OK(lahar_world_create(context, &o, &made));
  OK(lahar_world_set_gravity(made, (const double[3]){0, -9.81, NAN}));
  lahar_world_free(made);

  /* GIMP without sizes, a size that is none, a particle on the axis of symmetry, walls too close, a particle behind a wall. */
  OK(lahar_particles_init(&particles, sizeof particles));
  particles.count = 1;
  particles.position.data = position;
  particles.volume.data = volume;
  particles.density = 1000.0;
  OK(lahar_world_options_init(&o, sizeof o));
  o.spacing = 0.1;
  o.dimension = 2;
  o.shape = LAHAR_SHAPE_CONTIGUOUS_GIMP;
  o.wall_treatment = LAHAR_WALLS_MODIFIED;
  o.axisymmetric = 1;
  OK(lahar_world_create(context, &o, &made));
  REFUSED(made, lahar_body_add_particles(made, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "GIMP shape functions need the sizes");
  particles.size.data = size;
  REFUSED(made, lahar_body_add_particles(made, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "size of particle 0 must be positive");
  size[1] = 0.11;
  REFUSED(made, lahar_body_add_particles(made, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "more than the spacing of 0.1 m");
  size[1] = 0.1;
  position[0] = -0.05;
  REFUSED(made, lahar_body_add_particles(made, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "must have a positive radius");
  position[0] = 0.05;
  REFUSED(made, lahar_world_set_gravity(made, (const double[3]){1, 0, 0}), LAHAR_ERROR_UNSUPPORTED, "along the axis y alone");
  OK(lahar_wall_init(&wall, sizeof wall));
  wall.axis = 1;
  wall.position = 0.13;
  OK(lahar_wall_add(made, &wall, &id));
  wall.side = -1;
  wall.position = 0.17;
  REFUSED(made, lahar_wall_add(made, &wall, &id), LAHAR_ERROR_UNSUPPORTED, "less than half a cell");
  REFUSED(made, lahar_body_add_particles(made, material, &particles, &id), LAHAR_ERROR_INVALID_ARGUMENT, "is behind a wall");
  position[1] = 0.15;
  OK(lahar_body_add_particles(made, material, &particles, &id));
  REFUSED(made, lahar_body_set_f_bar(made, id, 2), LAHAR_ERROR_INVALID_ARGUMENT, "`on` must be 0 or 1");
  REFUSED(made, lahar_body_set_f_bar(made, 99, 1), LAHAR_ERROR_NOT_FOUND, "no body has the id 99");
  OK(lahar_body_set_f_bar(made, id, 1));
  OK(lahar_world_step_auto(made, NULL));
  lahar_world_free(made);

  /* A particle that is driven through the axis of symmetry. */
  o.shape = LAHAR_SHAPE_UNIFORM_GIMP;
  o.wall_treatment = LAHAR_WALLS_PLAIN;
  OK(lahar_world_create(context, &o, &made));
  OK(lahar_body_add_particles(made, material, &particles, &id));
  {
    lahar_prescribed_velocity inwards;
    lahar_status status = LAHAR_OK;
    int step;
    OK(lahar_prescribed_velocity_init(&inwards, sizeof inwards));
    inwards.components = LAHAR_COMPONENT_X;
    inwards.velocity[0] = -1.0;
    for (step = 0; step < 3; ++step) {
      inwards.box_min[step] = -1.0;
      inwards.box_max[step] = 1.0;
    }
    OK(lahar_prescribed_velocity_add(made, &inwards, NULL));
    for (step = 0; step < 10000 && status == LAHAR_OK; ++step) status = lahar_world_step_auto(made, NULL);
    CHECK(status == LAHAR_ERROR_OUTSIDE_GRID);
    REFUSED(made, lahar_world_step_auto(made, NULL), LAHAR_ERROR_OUTSIDE_GRID, "add a slip wall at x = 0");
  }
  lahar_world_free(made);
}

int main(int argc, char **argv) {
  if (argc < 2) return 2;
  context = make_context((const char *const[]){argv[1], NULL});
  material = make_elastic(context);
  world = make_world(context);
  if (failures) return 1;
  bad_methods();
  lahar_world_free(world);
  lahar_material_free(material);
  lahar_context_free(context);
  return failures != 0;
}
