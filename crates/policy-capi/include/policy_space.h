/* Policy Space: physics-based characters steered by blending the parameters of tiny policies.
 *
 * Units are SI and radians. World space is right-handed with z up. Quaternions are in the order x, y, z, w.
 *
 * Handles. A function that makes a handle returns NULL on failure. Every handle is freed once, by its own function;
 * freeing NULL does nothing. A PsPack never changes and may be used by several threads at once. A PsController and a
 * PsState belong to one thread at a time. Handles may be freed in any order.
 *
 * Errors. A null pointer, a wrong count, an unknown index or a number that is not finite is an error, and then the
 * function has changed nothing unless it says otherwise. ps_last_error gives the text. No panic crosses the border.
 *
 * Arrays belong to the caller. Pointers that the library returns are valid as long as the handle they were asked of.
 * Pointers must be aligned for their type and valid for the given count, and only an output may change meanwhile.
 *
 * A struct of zeros is a valid PsCommand. This file is generated from Rust by cbindgen.
 */


#ifndef POLICY_SPACE_H
#define POLICY_SPACE_H

#include <stddef.h>
#include <stdint.h>

// Version of this interface. It changes whenever a function or struct changes in a way that a compiled program would
// notice.
#define PS_ABI_VERSION 1

// Stands for "none" where an index is expected.
#define PS_NONE -1

// Most layers of a policy.
#define PS_MAX_LAYERS 4

// Most policies of a blend.
#define PS_MAX_BLEND_TERMS 16

// How a call ended.
enum PsStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It did what it says.
  PS_STATUS_OK = 0,
  // A pointer is null where there must be something.
  PS_STATUS_NULL_POINTER = 1,
  // An array has too few entries, or another number of entries than the skeleton asks for.
  PS_STATUS_WRONG_COUNT = 2,
  // A number is not finite or out of its range, or a quaternion is not of length 1.
  PS_STATUS_BAD_NUMBER = 3,
  // There is no body, joint, node, path, skill or kind of that index.
  PS_STATUS_BAD_INDEX = 4,
  // A text is not UTF-8, or no part of the pack has that name.
  PS_STATUS_BAD_NAME = 5,
  // The file can't be read.
  PS_STATUS_FILE = 6,
  // The bytes are no pack, or the pack is damaged.
  PS_STATUS_BAD_PACK = 7,
  // The pack or state is for another skeleton.
  PS_STATUS_OTHER_SKELETON = 8,
  // The state is none of this pack.
  PS_STATUS_BAD_STATE = 9,
  // The pack does not have it: packs of version 1 have no motors and no MJCF.
  PS_STATUS_ABSENT = 10,
  // The library has a bug. Free the handles of the call and go on without them.
  PS_STATUS_PANIC = 11,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsStatus PsStatus;
#else
typedef int32_t PsStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Kinds of parts that have names.
enum PsPart
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Bodies, the root first, each parent before its children: the order of PsSensed.bodies.
  PS_PART_BODY = 0,
  // Hinges: the order of joint velocities, actions and joint targets.
  PS_PART_JOINT = 1,
  // Nodes of the policy graph. The policy of a node has the same index.
  PS_PART_NODE = 2,
  // Paths of the policy graph.
  PS_PART_PATH = 3,
  // Episodic skills.
  PS_PART_SKILL = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsPart PsPart;
#else
typedef int32_t PsPart;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Where on the graph to go.
enum PsGoal
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Stay at the present position.
  PS_GOAL_STAY = 0,
  // A coordinate on a path.
  PS_GOAL_PATH = 1,
  // A node, by the cheapest way.
  PS_GOAL_NODE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsGoal PsGoal;
#else
typedef int32_t PsGoal;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How a blend of policies becomes one action.
enum PsBlendMode
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Interpolate the parameters: the method of the paper.
  PS_BLEND_MODE_PARAMETERS = 0,
  // Evaluate every policy and interpolate their actions.
  PS_BLEND_MODE_ACTIONS = 1,
  // The policy with the greatest blend weight alone.
  PS_BLEND_MODE_SWITCH = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsBlendMode PsBlendMode;
#else
typedef int32_t PsBlendMode;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How products are summed.
enum PsArithmetic
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The same bits on every machine.
  PS_ARITHMETIC_REPRODUCIBLE = 0,
  // Fused multiply-add where the processor has it.
  PS_ARITHMETIC_FUSED = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsArithmetic PsArithmetic;
#else
typedef int32_t PsArithmetic;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why an episodic skill ended.
enum PsSkillEnd
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The discriminator recognised the motion to return to.
  PS_SKILL_END_RECOGNISED = 0,
  // The time limit was reached.
  PS_SKILL_END_TIME_LIMIT = 1,
  // Another skill took over, or the controller was reset or put elsewhere.
  PS_SKILL_END_INTERRUPTED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsSkillEnd PsSkillEnd;
#else
typedef int32_t PsSkillEnd;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why a requested skill does not start.
enum PsRefusal
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The recovery skill was requested while the character is up.
  PS_REFUSAL_UPRIGHT = 0,
  // The pack has no such skill.
  PS_REFUSAL_UNKNOWN = 1,
  // It was pending for 4 s and could not start.
  PS_REFUSAL_TOOK_TOO_LONG = 2,
  // It was pending when the recovery skill started after a fall.
  PS_REFUSAL_FELL = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsRefusal PsRefusal;
#else
typedef int32_t PsRefusal;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why the state was not acted on.
enum PsFault
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It was acted on.
  PS_FAULT_NONE = 0,
  // A number is not finite, or a quaternion is not of length 1.
  PS_FAULT_BAD_NUMBER = 1,
  // It does not have the bodies and hinges of the skeleton.
  PS_FAULT_WRONG_SIZE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsFault PsFault;
#else
typedef int32_t PsFault;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What an evaluation took.
enum PsEvaluation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // One policy.
  PS_EVALUATION_SINGLE = 0,
  // Interpolated parameters, cached in an earlier tick.
  PS_EVALUATION_CACHED = 1,
  // Interpolated parameters, without building them.
  PS_EVALUATION_FUSED = 2,
  // Every policy, actions interpolated.
  PS_EVALUATION_ACTIONS = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum PsEvaluation PsEvaluation;
#else
typedef int32_t PsEvaluation;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Steers one character.
typedef struct PsController PsController;

// A character: skeleton, policies, graph, skills, normalisers. Immutable, shared by its controllers.
typedef struct PsPack PsPack;

// Everything that the next tick of a controller depends on. Make one, then save into it as often as you like.
typedef struct PsState PsState;

// Sizes and rates of a pack.
typedef struct PsPackInfo {
  // Bodies, the root included.
  size_t body_count;
  // Hinges.
  size_t joint_count;
  // Inputs of a policy: the observation, then two numbers of the target.
  size_t policy_input_len;
  // Control ticks per second.
  float control_hz;
  // Physics steps per second in training; 0 where the pack does not say.
  float physics_hz;
  // Mass of all bodies, kilograms; 0 where the pack does not say.
  float mass_kg;
} PsPackInfo;

// A hinge.
typedef struct PsJoint {
  // The body that it moves.
  int32_t body;
  // Axis in the frame of that body, of any length but zero.
  float axis[3];
  // Least and greatest angle, radians. Joint targets may lie outside: don't clamp them.
  float range[2];
  // Joint target of a zero action, radians.
  float action_centre;
  // Radians of joint target per unit of action.
  float action_gain;
} PsJoint;

// The motor of a hinge: `torque = clamp(gain * (target - angle), -force_limit, force_limit) - damping * velocity`.
typedef struct PsMotor {
  // Newton metres per radian.
  float gain;
  // Newton metre seconds per radian. A property of the joint: integrated implicitly, not clamped.
  float damping;
  // Greatest torque of the gain, newton metres.
  float force_limit;
  // Inertia of the motor about the hinge, kilogram square metres.
  float armature;
} PsMotor;

// A node of the policy graph.
typedef struct PsNode {
  // A root lower than this above the ground, metres, means that the character has fallen; NaN where no height does.
  float fall_height;
  // Speed that the policy was trained for, metres per second; NaN where it has none.
  float speed_mps;
  // 1 for a policy that faces one way and moves another, else 0.
  int32_t strafes;
} PsNode;

// Choices that are made once for a controller. Fill it with ps_config_default, then change what you want.
typedef struct PsConfig {
  // PsArithmetic.
  int32_t arithmetic;
  // PsBlendMode.
  int32_t blend_mode;
  // Not 0: cache the parameters of a resting blend, as large as one policy.
  int32_t cache_blends;
  // Not 0: start the recovery skill when the character has fallen.
  int32_t auto_recover;
  // Not 0: start it too when standing up out of a low gait takes longer than 0.1 s, or 2.2 s where the gait has a rising variant.
  int32_t assist_rise;
  // Node to start at.
  int32_t start_node;
  // Time over which joint targets pass from one policy to the other when a skill starts or ends, seconds, at most 3600; 0 for a
  // jump.
  float handover_secs;
  // Time after a skill in which the character stays in the gait that the skill returns to, and turns little, seconds, at most
  // 3600; 0 to go on at once.
  float settle_secs;
  // Not 0: fast gaits slow down and slow ones speed up while the target lies far off the heading.
  int32_t turn_assist;
  // Angle from which the turn assist slows a faster gait down, radians.
  float turn_begin_radians;
  // Angle from which it does so fully, radians; more than turn_begin_radians.
  float turn_full_radians;
  // Angle from which the turn assist speeds a slower gait up, radians.
  float turn_slow_begin_radians;
  // Angle from which it does so fully, radians; more than turn_slow_begin_radians.
  float turn_slow_full_radians;
  // Not 0: hold the course and lead into turns.
  int32_t steering;
  // How much further the policy is asked to turn, for each radian between the course and the target; at least 0.
  float steering_lead;
  // How fast the trim against drift grows, radians a second for each radian between course and target; at least 0.
  float steering_trim_per_second;
  // Largest trim, radians; at least 0.
  float steering_trim_limit_radians;
  // Time constant of the low-pass on the velocity, seconds; at least 0.
  float steering_velocity_secs;
  // Not 0: stop for a moment when something holds the character up.
  int32_t give_way;
  // Share of its speed towards the target below which it is held up, in (0, 1).
  float give_way_held_up_share;
  // How long it stands then, seconds; 0 to 3600.
  float give_way_stop_secs;
  // Not 0: blend gaits with their variants for rough ground where the ground is uneven.
  int32_t footing;
  // Not 0: blend gaits with their starting variants while the character sets off from a stand, with their turning variants
  // while it turns, with their stopping variants while it comes to a stand, with their agile variants while it does not move
  // yet as it is asked to, with their steady variants once it has for a while, with their resting variants where it is to
  // go nowhere, and with their rising variants while it stands up out of them.
  int32_t agility;
  // Not 0: step back with the pack's first policy that strafes when the body tips over backwards, and catch a push that
  // drives it off its course by the catching variants of its gaits.
  int32_t capture_steps;
} PsConfig;

// Motion of one body: of its frame as in the MJCF, not of its centre of mass. World space, all at one moment.
typedef struct PsBody {
  // Origin of the frame, metres.
  float position[3];
  // Turns body space to world space: x, y, z, w, of length 1. MuJoCo has w first.
  float rotation[4];
  // Velocity of the frame's origin, metres per second.
  float linear_velocity[3];
  // Radians per second about the world's axes.
  float angular_velocity[3];
} PsBody;

// What the physics tells of a character.
typedef struct PsSensed {
  // One entry for each body of the pack, in its order.
  const struct PsBody *bodies;
  // Entries of `bodies`: exactly PsPackInfo.body_count.
  size_t body_count;
  // Angular velocity of each hinge of the pack, in its order, radians per second.
  const float *joint_velocities;
  // Entries of `joint_velocities`: exactly PsPackInfo.joint_count.
  size_t joint_count;
  // Height of the ground below the root, metres.
  float ground_height;
  // For each body, height of the ground where it comes to, metres: see ps_pack_ground_lookahead_secs. Those of other bodies are
  // not read. NULL for level ground. As many entries as `bodies`.
  const float *ground_heights;
} PsSensed;

// One policy's part in a blend.
typedef struct PsBlendTerm {
  // The policy: index of its node.
  int32_t policy;
  // Blend weight in each layer, first to last; layers that the policy lacks are ignored.
  float weights[PS_MAX_LAYERS];
} PsBlendTerm;

// What a game asks of a character each tick. Zeros mean: stay.
typedef struct PsCommand {
  // Not 0: go to `target`. 0: stand where it is.
  int32_t has_target;
  // Point on the ground, world x and y, metres.
  float target[2];
  // Not 0: face along `facing`, with a policy that strafes. 0: face the target.
  int32_t has_facing;
  // Direction to face, world x and y, of any length.
  float facing[2];
  // PsGoal.
  int32_t goal;
  // The path or node of the goal.
  int32_t goal_index;
  // Coordinate on the path: i + t lies between its nodes i and i + 1. Clamped to the path.
  float coordinate;
  // Not 0: request `skill`. It stays pending until the position on the graph allows it.
  int32_t has_skill;
  // The skill that is requested.
  int32_t skill;
  // Blend weights that replace the position on the graph, or NULL.
  const struct PsBlendTerm *blend;
  // Entries of `blend`, at most PS_MAX_BLEND_TERMS; 0 for none.
  size_t blend_count;
} PsCommand;

// A position on the graph: `t` in [0, 1] of the way from one node to another.
typedef struct PsPosition {
  // Node at 0.
  int32_t from_node;
  // Node at 1.
  int32_t to_node;
  // How far between them.
  float t;
} PsPosition;

// What a controller did in its last tick.
typedef struct PsReport {
  // Position on the graph.
  struct PsPosition position;
  // Where on the graph it is going.
  struct PsPosition goal;
  // Blend weights that were evaluated: the first blend_count entries.
  struct PsBlendTerm blend[PS_MAX_BLEND_TERMS];
  // Policies of the blend.
  size_t blend_count;
  // PsEvaluation.
  int32_t evaluation;
  // The target as the policy saw it.
  float target[2];
  // The skill that runs, or PS_NONE.
  int32_t skill;
  // Seconds since it started.
  float skill_secs;
  // Latest score of its discriminator, in [0, 1]; NaN before there is one.
  float skill_score;
  // The skill that starts once the position on the graph allows it, or PS_NONE.
  int32_t pending_skill;
  // The skill that started in this tick, or PS_NONE.
  int32_t started_skill;
  // The skill that ended since the tick before, or PS_NONE.
  int32_t ended_skill;
  // PsSkillEnd; PS_NONE when none ended.
  int32_t skill_end;
  // The skill whose request was refused in this tick, or PS_NONE.
  int32_t refused_skill;
  // PsRefusal; PS_NONE when none was refused.
  int32_t refusal;
  // 1: the root has been lower than the policies in use allow for some time.
  int32_t fallen;
  // PsFault. When it is not 0, the joint targets are those of a zero action and nothing else was done.
  int32_t fault;
  // 1: the tick's time differs by more than a quarter from the control period.
  int32_t off_rate;
} PsReport;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// `PS_ABI_VERSION` of the library that is loaded; compare it with that of the header.
uint32_t ps_abi_version(void);

// Why the last call of this thread failed, in English and UTF-8: what was expected and what was found. Empty when no
// call of this thread has failed; a call that succeeds leaves it as it is. Valid until the next failure in this thread.
const char *ps_last_error(void);

// Status of the last call of this thread that failed, for functions that return no status.
PsStatus ps_last_status(void);

// A few words for a status, such as "null pointer". Never null.
const char *ps_status_name(int32_t status);

// A pack from the bytes of a file of version 1 or 2. NULL on failure.
struct PsPack *ps_pack_from_bytes(const uint8_t *bytes, size_t len);

// A pack from a file; the path is UTF-8. NULL on failure.
struct PsPack *ps_pack_from_file(const char *path);

// Frees a pack. Its controllers and states go on.
void ps_pack_free(struct PsPack *pack);

// Number of parts of a kind (PsPart). 0 also on failure.
size_t ps_pack_count(const struct PsPack *pack, int32_t part);

// Name of a part. NULL on failure. Valid as long as the pack.
const char *ps_pack_name(const struct PsPack *pack, int32_t part, int32_t part_index);

// Index of the part with this name. PS_NONE on failure.
int32_t ps_pack_find(const struct PsPack *pack, int32_t part, const char *name);

// Name of the character. NULL on failure. Valid as long as the pack.
const char *ps_pack_character(const struct PsPack *pack);

// The body as MJCF text, UTF-8. NULL on failure and for packs of version 1. Valid as long as the pack.
const char *ps_pack_mjcf(const struct PsPack *pack);

// The skinned mesh, a binary glTF file of `*len` bytes. NULL on failure and for packs without one. Valid as long as the
// pack.
const uint8_t *ps_pack_mesh(const struct PsPack *pack,
                            size_t *len);

// Writes sizes and rates.
PsStatus ps_pack_info(const struct PsPack *pack, struct PsPackInfo *info);

// Seconds after which the ground below a body counts for PsSensed.ground_heights: where the body then is at its present velocity.
// Negative for a body that senses no ground of its own, and on failure.
float ps_pack_ground_lookahead_secs(const struct PsPack *pack,
                                    int32_t body);

// The body that a body hangs on. PS_NONE for the root and on failure.
int32_t ps_pack_parent(const struct PsPack *pack, int32_t body);

// Writes a hinge.
PsStatus ps_pack_joint(const struct PsPack *pack, int32_t joint, struct PsJoint *out);

// Writes the motors, one for each hinge. `capacity` is the number of entries that `motors` has room for. Packs of version 1
// have none (PS_STATUS_ABSENT).
PsStatus ps_pack_motors(const struct PsPack *pack,
                        struct PsMotor *motors,
                        size_t capacity);

// Writes a node of the graph.
PsStatus ps_pack_node(const struct PsPack *pack, int32_t node, struct PsNode *out);

// Number of nodes of a path; its coordinates run from 0 to one less. 0 on failure.
size_t ps_pack_path_len(const struct PsPack *pack, int32_t path);

// Writes the nodes of a path, in the order of its coordinates. `capacity` is the number of entries that `nodes` has room
// for.
PsStatus ps_pack_path_nodes(const struct PsPack *pack,
                            int32_t path,
                            int32_t *nodes,
                            size_t capacity);

// The skill that brings a fallen character to its feet. PS_NONE where there is none, and on failure.
int32_t ps_pack_recovery(const struct PsPack *pack);

// Writes the usual choices.
PsStatus ps_config_default(struct PsConfig *config);

// A controller at its start node. `config` may be NULL for the usual choices. Allocates. NULL on failure.
struct PsController *ps_controller_new(const struct PsPack *pack,
                                       const struct PsConfig *config);

// Frees a controller.
void ps_controller_free(struct PsController *controller);

// One control tick: from what the character senses and what the game asks to joint targets in radians, one for each hinge.
//
// `dt_secs` is the time since the last tick, usually 1 / control_hz; at most 0.25 s of it count. `capacity` is the number of
// entries that `targets` has room for. A bad number in `sensed` is PS_STATUS_BAD_NUMBER; the targets are then those of a
// zero action and nothing else has changed but the report. With any other error nothing has changed. Does not allocate.
PsStatus ps_controller_tick(struct PsController *controller,
                            const struct PsSensed *sensed,
                            const struct PsCommand *command,
                            float dt_secs,
                            float *targets,
                            size_t capacity);

// The first half of a tick, for an engine that evaluates policies itself: writes the inputs of the policy, normalised, and
// sets the blend of the report. Call ps_controller_accept with the action. `capacity` is the number of entries that `input`
// has room for, at least PsPackInfo.policy_input_len. Errors are those of ps_controller_tick; the input is then not
// written. Does not allocate.
PsStatus ps_controller_prepare(struct PsController *controller,
                               const struct PsSensed *sensed,
                               const struct PsCommand *command,
                               float dt_secs,
                               float *input,
                               size_t capacity);

// The second half of a tick: from the action of the policy, one number for each hinge, to joint targets in radians. Numbers
// that are not finite count as 0. `targets` may be the array of `action`. Does not allocate.
PsStatus ps_controller_accept(struct PsController *controller,
                              const float *action,
                              size_t action_count,
                              float *targets,
                              size_t capacity);

// Back to the start node, as after the character was put elsewhere. Does not allocate.
PsStatus ps_controller_reset(struct PsController *controller);

// Puts the controller at a position on the graph at once: `t` in [0, 1] of the way from one node to another that is joined
// to it, or the same node twice. Does not allocate.
PsStatus ps_controller_place_at(struct PsController *controller,
                                int32_t from_node,
                                int32_t to_node,
                                float t);

// Sets how a blend becomes an action (PsBlendMode), from the next tick on.
PsStatus ps_controller_set_blend_mode(struct PsController *controller, int32_t mode);

// Forgets a skill that was requested and has not started. Returns it, or PS_NONE.
int32_t ps_controller_cancel_skill(struct PsController *controller);

// Goes on with another pack for the same skeleton, for hot reload. Position and skills are kept by their names. Allocates.
PsStatus ps_controller_set_pack(struct PsController *controller,
                                const struct PsPack *pack);

// Writes what the controller did in its last tick. Does not allocate.
PsStatus ps_controller_report(const struct PsController *controller, struct PsReport *report);

// The state of a new controller. Allocates. NULL on failure.
struct PsState *ps_state_new(const struct PsPack *pack);

// Frees a state.
void ps_state_free(struct PsState *state);

// Saves a controller into a state of the same skeleton. Does not allocate.
PsStatus ps_controller_save(const struct PsController *controller, struct PsState *state);

// Goes on from a saved state: the next ticks give the bits that they gave then. The state must be one of the controller's
// pack. Does not allocate.
PsStatus ps_controller_restore(struct PsController *controller,
                               const struct PsState *state);

// Bytes of a state: the same number for all states of a pack. 0 on failure.
size_t ps_state_byte_len(const struct PsState *state);

// Writes a state as bytes that are the same on every machine. `capacity` is the number of bytes that there is room for. Does
// not allocate.
PsStatus ps_state_to_bytes(const struct PsState *state,
                           uint8_t *bytes,
                           size_t capacity);

// Reads a state from bytes that were written for the same pack. After PS_STATUS_BAD_STATE it is the state of a new
// controller; after any other error it is unchanged. Does not allocate.
PsStatus ps_state_from_bytes(struct PsState *state,
                             const struct PsPack *pack,
                             const uint8_t *bytes,
                             size_t len);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* POLICY_SPACE_H */
