/* Walks 10 m in MuJoCo: loads a pack and its body, then sense, tick, actuate, step.
 *
 *     cc walk.c $(pkg-config --cflags --libs policy_space) -I MUJOCO/include -L MUJOCO/lib -lmujoco -lm -o walk
 *     ./walk humanoid.pack.safetensors
 *
 * Lines that begin with ps_ or Ps are this library's; all others are plain MuJoCo. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>
#include <policy_space.h>

#define METRES 10.0
#define LIMIT_SECS 30.0

static void fail(const char *what, const char *why) {
  fprintf(stderr, "walk: %s: %s\n", what, why);
  exit(EXIT_FAILURE);
}

static void check(PsStatus status, const char *what) {
  if (status != PS_STATUS_OK) fail(what, ps_last_error());
}

static void *array(size_t count, size_t size) {
  void *memory = calloc(count, size);
  if (!memory) fail("memory", "expected more");
  return memory;
}

/* Where the bodies and hinges of the pack are in MuJoCo. */
typedef struct {
  PsPackInfo info;
  int *body, *dof, *actuator;
} Layout;

static mjModel *load_body(const PsPack *pack) {
  const char *mjcf = ps_pack_mjcf(pack);
  if (!mjcf) fail("the pack", ps_last_error());
  char error[1000] = "";
  mjVFS files;
  mj_defaultVFS(&files);
  mj_addBufferVFS(&files, "body.xml", mjcf, (int)strlen(mjcf));
  mjModel *model = mj_loadXML("body.xml", &files, error, sizeof error);
  mj_deleteVFS(&files);
  if (!model) fail("the MJCF of the pack", error);
  return model;
}

static int find(const mjModel *model, int type, const PsPack *pack, PsPart part, size_t index) {
  const char *name = ps_pack_name(pack, part, (int32_t)index);
  int id = name ? mj_name2id(model, type, name) : -1;
  if (id < 0) fail("the MJCF of the pack lacks", name ? name : ps_last_error());
  return id;
}

static Layout layout_of(const mjModel *model, const PsPack *pack) {
  Layout layout;
  check(ps_pack_info(pack, &layout.info), "the pack");
  layout.body = array(layout.info.body_count, sizeof(int));
  layout.dof = array(layout.info.joint_count, sizeof(int));
  layout.actuator = array(layout.info.joint_count, sizeof(int));
  for (size_t i = 0; i < layout.info.body_count; i++)
    layout.body[i] = find(model, mjOBJ_BODY, pack, PS_PART_BODY, i);
  for (size_t i = 0; i < layout.info.joint_count; i++) {
    int joint = find(model, mjOBJ_JOINT, pack, PS_PART_JOINT, i);
    layout.dof[i] = model->jnt_dofadr[joint];
    layout.actuator[i] = -1;
    for (int a = 0; a < (int)model->nu; a++)
      if (model->actuator_trnid[2 * a] == joint) layout.actuator[i] = a;
    if (layout.actuator[i] < 0) fail("no motor drives", ps_pack_name(pack, PS_PART_JOINT, (int32_t)i));
  }
  return layout;
}

static void sense(const mjModel *model, const mjData *data, const Layout *layout, PsBody *bodies,
                  float *velocities) {
  for (size_t i = 0; i < layout->info.body_count; i++) {
    int id = layout->body[i];
    mjtNum velocity[6]; /* angular, then linear, at the origin of the body's frame, world axes */
    mj_objectVelocity(model, data, mjOBJ_XBODY, id, velocity, 0);
    for (int k = 0; k < 3; k++) {
      bodies[i].position[k] = (float)data->xpos[3 * id + k];
      bodies[i].rotation[k] = (float)data->xquat[4 * id + k + 1]; /* MuJoCo's w is first, ours is last */
      bodies[i].angular_velocity[k] = (float)velocity[k];
      bodies[i].linear_velocity[k] = (float)velocity[k + 3];
    }
    bodies[i].rotation[3] = (float)data->xquat[4 * id];
  }
  for (size_t i = 0; i < layout->info.joint_count; i++) velocities[i] = (float)data->qvel[layout->dof[i]];
}

int main(int argc, char **argv) {
  if (argc != 2) fail("usage", "walk PACK");
  if (ps_abi_version() != PS_ABI_VERSION) fail("the library", "expected the version of the header");
  PsPack *pack = ps_pack_from_file(argv[1]);
  if (!pack) fail(argv[1], ps_last_error());
  mjModel *model = load_body(pack);
  mjData *data = mj_makeData(model);
  Layout layout = layout_of(model, pack);
  PsController *controller = ps_controller_new(pack, NULL);
  int32_t speed = ps_pack_find(pack, PS_PART_PATH, "speed");
  if (!controller || speed == PS_NONE) fail("the controller", ps_last_error());

  size_t joints = layout.info.joint_count;
  PsBody *bodies = array(layout.info.body_count, sizeof *bodies);
  float *velocities = array(joints, sizeof *velocities), *targets = array(joints, sizeof *targets);
  PsSensed sensed = {.bodies = bodies, .body_count = layout.info.body_count,
                     .joint_velocities = velocities, .joint_count = joints, .ground_height = 0};
  PsCommand command = {.has_target = 1, .target = {100, 0},
                       .goal = PS_GOAL_PATH, .goal_index = speed, .coordinate = 1}; /* 0 Idle, 1 Walk */
  float dt_secs = 1 / layout.info.control_hz;
  int substeps = (int)lround(dt_secs / model->opt.timestep), ticks = 0;

  mj_step1(model, data); /* the halves of mj_step, so that positions and velocities are of one moment */
  while (data->xpos[3 * layout.body[0]] < METRES && data->time < LIMIT_SECS) {
    sense(model, data, &layout, bodies, velocities);
    check(ps_controller_tick(controller, &sensed, &command, dt_secs, targets, joints), "the tick");
    for (size_t i = 0; i < joints; i++) data->ctrl[layout.actuator[i]] = targets[i];
    for (int step = 0; step < substeps; step++) {
      mj_step2(model, data);
      mj_step1(model, data);
    }
    PsReport report;
    check(ps_controller_report(controller, &report), "the report");
    if (report.fallen) fail("the character", "it fell");
    ticks++;
  }
  double walked = data->xpos[3 * layout.body[0]];
  printf("walked %.2f m in %d ticks, %.2f s\n", walked, ticks, data->time);

  free(bodies), free(velocities), free(targets);
  free(layout.body), free(layout.dof), free(layout.actuator);
  ps_controller_free(controller);
  ps_pack_free(pack);
  mj_deleteData(data);
  mj_deleteModel(model);
  return walked >= METRES ? EXIT_SUCCESS : EXIT_FAILURE;
}
