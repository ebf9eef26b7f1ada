// SPDX-License-Identifier: Apache-2.0
// The C interface of Sunder: soft tissue that tears, from arrays. C99 and C++; Python ctypes and C#
// P/Invoke read the same declarations. Units: mm, N, MPa; angles in degrees; times in milliseconds.
//
// Rules that hold for every function:
// - It returns a status and never aborts, throws or exits. On failure nothing has changed, unless
//   the function says otherwise; sunder_last_error() has one sentence about it.
// - A handle is a number that is looked up, not a pointer that is followed: null, forged and
//   destroyed handles, and handles of another kind, give SUNDER_ERROR_HANDLE.
// - Ids are 0-based and 32-bit. Arrays are dense, row by row; the caller owns them, and they are
//   copied before the call returns. The size of an array is its number of values, and it must be
//   exactly what the function states (else SUNDER_ERROR_SIZE, as of more than 2^31 - 1 rows).
// - Text goes out as UTF-8 into a buffer of the caller's: at most `capacity` bytes with the closing
//   zero are written, `length` (may be null) receives the length without it. A null buffer with
//   capacity 0 asks for the length alone.
// - A number that goes in must be finite, where it is read: else SUNDER_ERROR_VALUE from the very
//   call that hands it over. Whether finite numbers make sense together is checked when a plan or a
//   simulation is made (SUNDER_ERROR_INPUT).
// - Option and result structs begin with `struct_size`: sizeof(the struct) as the caller was
//   compiled. `sunder_step step = SUNDER_STEP_INIT;` sets it and all defaults; each struct that a
//   caller makes has such a macro. Later versions append members, and a struct may be shorter or
//   longer than the library's. Of a result, what both know is written, and not a byte beyond: a
//   newer caller's further members keep what they held. Of options, what an older caller leaves
//   out has its default, and what a newer caller adds must be zero. A size below the struct's
//   first version is an error, and so is one that no version comes near (over 65536 bytes, of
//   options over 1024): it was never set.
// - The *_init functions do what the macros do, for languages without macros. They write the struct
//   as this library has it, so the caller's must be that of the same version.
//
// Threads: different handles may be used by different threads at once. One handle serves one
// call at a time: a second one returns SUNDER_ERROR_BUSY at once and does nothing. Only
// sunder_simulation_cancel and sunder_simulation_destroy may be called for a handle that is in use.
// Callbacks run on the thread that made the call, during it, and find their own handle busy.
#ifndef SUNDER_SUNDER_H
#define SUNDER_SUNDER_H

#include <stddef.h>
#include <stdint.h>

#define SUNDER_VERSION_MAJOR 0
#define SUNDER_VERSION_MINOR 1
#define SUNDER_VERSION_PATCH 0

#if defined(_WIN32) && defined(SUNDER_MAKES_LIBRARY)
#define SUNDER_API __declspec(dllexport)
#elif defined(_WIN32)
#define SUNDER_API
#else
#define SUNDER_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Status ---------------------------------------------------------------------------------- */

typedef int32_t sunder_status;
enum {
  SUNDER_OK = 0,
  SUNDER_ERROR_INTERNAL = 1,     ///< a defect of the library
  SUNDER_ERROR_ORDER = 2,        ///< a call that does not fit what was done before
  SUNDER_ERROR_INPUT = 3,        ///< the scene is wrong; the text names the place and the value
  SUNDER_ERROR_DEVICE = 4,       ///< no such device, backend, route, or a feature is missing
  SUNDER_ERROR_NUMERICAL = 5,    ///< the promised accuracy cannot be kept; results so far stay
  SUNDER_ERROR_NULL = 6,         ///< a pointer that is needed is null
  SUNDER_ERROR_HANDLE = 7,       ///< no such handle (any more), or one of another kind
  SUNDER_ERROR_SIZE = 8,         ///< an array of another size
  SUNDER_ERROR_STRUCT_SIZE = 9,  ///< a struct_size that no version has, or unknown members set
  SUNDER_ERROR_VALUE = 10,       ///< an index or a value outside what is allowed, or not finite
  SUNDER_ERROR_BUSY = 11,        ///< the handle is in use by another call
  SUNDER_ERROR_MEMORY = 12,      ///< out of memory
  SUNDER_ERROR_CANCELLED = 13    ///< a callback or sunder_simulation_cancel asked for it
};

/// One line for a status; "unknown status" for any other number. Never null.
SUNDER_API const char* sunder_status_text(sunder_status status);
/// The last failure on this thread, one sentence; "" if there was none. Valid until the next
/// failure on this thread.
SUNDER_API const char* sunder_last_error(void);
/// The last failure of calls on one handle (a sunder_scene, sunder_plan or sunder_simulation).
SUNDER_API sunder_status sunder_error_of(const void* handle, char* text, size_t capacity,
                                         size_t* length);
/// Version of the library at run time; each may be null. See SUNDER_VERSION_MAJOR: with the same
/// major number (from 1 on) everything stays callable.
SUNDER_API void sunder_version(int32_t* major, int32_t* minor, int32_t* patch);

/* ---- Devices --------------------------------------------------------------------------------- */

typedef int32_t sunder_backend;
enum { SUNDER_BACKEND_AUTO = 0, SUNDER_BACKEND_CPU = 1, SUNDER_BACKEND_VULKAN = 2 };

typedef struct sunder_device {
  uint32_t struct_size;
  sunder_backend backend;
  int32_t index;   ///< among the devices of its backend, for sunder_solver_options::device
  int32_t chosen;  ///< 1: SUNDER_BACKEND_AUTO takes it
  char name[256];
  char driver[256];
  char precisions[32];  ///< "fp32 fp64"
  char why[256];        ///< why it is chosen, or why not
} sunder_device;

#define SUNDER_DEVICE_INIT \
  { sizeof(sunder_device), SUNDER_BACKEND_AUTO, 0, 0, "", "", "", "" }

SUNDER_API sunder_status sunder_device_count(int32_t* count);
SUNDER_API sunder_status sunder_device_at(int32_t index, sunder_device* device);

/* ---- Scene: the model and what acts on it ---------------------------------------------------- */

typedef struct sunder_scene_handle* sunder_scene;

SUNDER_API sunder_status sunder_scene_create(sunder_scene* scene);
SUNDER_API sunder_status sunder_scene_destroy(sunder_scene scene);

/// The body. `nodes`: (nodes x 3) coordinates [mm]; those that no tetrahedron uses keep their ids
/// and stay in place. `tets`: (tets x 4) node ids in either orientation: those of negative volume
/// (x1-x0) x (x2-x0) . (x3-x0) < 0 are turned, with a warning. `material_of`: one index of
/// sunder_scene_add_material per tetrahedron, or null with size 0: all 0. Sizes in values: 3 *
/// nodes, 4 * tets, tets. Replaces the mesh that was there. Shape and ids are checked when a plan
/// or a simulation is made.
SUNDER_API sunder_status sunder_scene_set_mesh(sunder_scene scene, const double* nodes,
                                               size_t nodes_size, const int32_t* tets,
                                               size_t tets_size, const int32_t* material_of,
                                               size_t material_of_size);

/// linear: theory of small strains; the others at any deformation (docs/method.md).
enum {
  SUNDER_LAW_LINEAR = 0,
  SUNDER_LAW_COROTATED = 1,
  SUNDER_LAW_NEO_HOOKEAN = 2,
  SUNDER_LAW_SAINT_VENANT_KIRCHHOFF = 3
};

/// element: each element changes its volume by itself; pooled: some 8 as one, so that nearly
/// incompressible tissue does not lock (docs/method.md).
enum { SUNDER_VOLUME_ELEMENT = 0, SUNDER_VOLUME_POOLED = 1 };

typedef struct sunder_material {
  uint32_t struct_size;
  uint32_t reserved;
  double young;      ///< E [MPa], above 0
  double poisson;    ///< nu, above -1 and below 0.5
  double yield;      ///< [MPa]; 0: unbreakable (a keyword of Python: yield_stress in board.py)
  const char* name;  ///< for messages; null: its index
  int32_t law;       ///< SUNDER_LAW_*
  int32_t reserved2;
  double density;  ///< [t/mm^3], water 1e-9; needed in motion and under gravity; 0: none
  /// K_c [MPa sqrt(mm)] at which cracks of model B grow; 0: none, Eq. 1 by yield decides
  double toughness;
  double energy;   ///< G_c [N/mm] in its place (1000 J/m^2); 0: none; one of the two
  int32_t volume;  ///< SUNDER_VOLUME_*
  int32_t reserved3;
} sunder_material;

#define SUNDER_MATERIAL_INIT                                                  \
  {                                                                           \
    sizeof(sunder_material), 0, 0, 0, 0, NULL, SUNDER_LAW_LINEAR, 0, 0, 0, 0, \
        SUNDER_VOLUME_ELEMENT, 0                                              \
  }

SUNDER_API void sunder_material_init(sunder_material* material);
/// Tissues by name, with their sources in docs/tissues.md: how many, and the name of each.
SUNDER_API sunder_status sunder_preset_count(int32_t* count);
SUNDER_API sunder_status sunder_preset_at(int32_t index, char* name, size_t capacity,
                                          size_t* length);
/// Writes what is known of a tissue into `material` (young to energy, 0 what nobody has measured);
/// its name and law stay. SUNDER_ERROR_VALUE: no such tissue.
SUNDER_API sunder_status sunder_material_preset(const char* preset, sunder_material* material);
/// `index` (may be null) receives 0, 1, ... in the order of calls.
SUNDER_API sunder_status sunder_scene_add_material(sunder_scene scene,
                                                   const sunder_material* material, int32_t* index);

enum {
  SUNDER_FIBRES_STRAIGHT = 0,  ///< along `direction` everywhere
  SUNDER_FIBRES_AROUND = 1,    ///< round the axis `direction` through `point`
  SUNDER_FIBRES_FIELD = 2      ///< as `field` says for each element
};

/// A family of fibres (docs/method.md "Fibres" and "Toughness by direction"). What is 0 is not
/// given, but k2 and poisson_along, which come with k1 and young_along.
typedef struct sunder_fibres {
  uint32_t struct_size;
  int32_t run;                ///< SUNDER_FIBRES_*
  double direction[3];        ///< of any length but 0
  double point[3];            ///< [mm]
  const double* field;        ///< (tets x 3), of any length but 0 where the material is
  size_t field_size;          ///< 3 * tets
  double k1, k2, dispersion;  ///< laws of finite deformation: k1 [MPa], dispersion 0 to 1/3
  double young_along, poisson_along, shear_along;  ///< law linear: the moduli [MPa]
  double yield_across;      ///< strength across [MPa]; the material's yield holds along
  double toughness_across;  ///< K_c of cracks across [MPa sqrt(mm)], the material's holds along
  double energy_across;     ///< G_c likewise [N/mm]
} sunder_fibres;

#define SUNDER_FIBRES_INIT                                                                       \
  {                                                                                              \
    sizeof(sunder_fibres), SUNDER_FIBRES_STRAIGHT, {0, 0, 0}, {0, 0, 0}, NULL, 0, 0, 0, 0, 0, 0, \
        0, 0, 0, 0                                                                               \
  }

SUNDER_API void sunder_fibres_init(sunder_fibres* fibres);
/// A family of a material that has been added, by its index; a second call adds a second one. A
/// field goes with the mesh that is there when the simulation is made.
SUNDER_API sunder_status sunder_scene_add_fibres(sunder_scene scene, int32_t material,
                                                 const sunder_fibres* fibres);
/// Where elements of two materials share faces they part by a law of their own (docs/method.md
/// "Interfaces"): traction grows with the opening up to `strength` [MPa] in tension, and parting
/// takes `energy` [N/mm]; in shear they bear `shear_ratio` of that strength (1: as much) and take
/// its square times the energy. All three are above 0. Numbered in the order of calls. By it the
/// scene is one of finite deformation; its fracture model is none, A or P.
///
/// The simulation's body has more nodes and elements than the mesh, behind the host's, whose ids
/// stay: one side of the faces keeps the nodes that are there, the other gets copies a little away,
/// and between them lie thin elements. All arrays by node or element have that body's size, which
/// sunder_engine (of a plan too) and sunder_simulation_body tell; sunder_simulation_body_nodes,
/// _corners and _parents tell what has come. Nodes where faces of an interface lie are best
/// selected by SUNDER_SELECT_FACES (those of the element that has the face), boxes and balls (all
/// copies that lie there); an id is that of one of the copies.
SUNDER_API sunder_status sunder_scene_add_interface(sunder_scene scene, int32_t first_material,
                                                    int32_t second_material, double strength,
                                                    double energy, double shear_ratio);

typedef int32_t sunder_selection_kind;
enum {
  SUNDER_SELECT_IDS = 0,   ///< ids, id_count
  SUNDER_SELECT_BOX = 1,   ///< min <= x <= max of nodes, or of the centroids of elements
  SUNDER_SELECT_BALL = 2,  ///< |x - min| <= radius; nodes only
  SUNDER_SELECT_FACES = 3  ///< those of faces of elements, ids: three nodes each; nodes only
};
/// Nodes or elements. This struct has no version: it never changes.
typedef struct sunder_selection {
  sunder_selection_kind kind;
  int32_t reserved;
  const int32_t* ids;
  size_t id_count;
  double min[3];  ///< least corner of the box, or the ball's centre [mm]
  double max[3];
  double radius;
} sunder_selection;

#define SUNDER_SELECTION_INIT \
  { SUNDER_SELECT_IDS, 0, NULL, 0, {0, 0, 0}, {0, 0, 0}, 0 }

enum { SUNDER_AXIS_X = 1, SUNDER_AXIS_Y = 2, SUNDER_AXIS_Z = 4, SUNDER_AXES_ALL = 7 };

typedef struct sunder_support {
  uint32_t struct_size;
  uint32_t axes;  ///< held axes, a sum of SUNDER_AXIS_*
  sunder_selection nodes;
} sunder_support;

#define SUNDER_SUPPORT_INIT \
  { sizeof(sunder_support), SUNDER_AXES_ALL, SUNDER_SELECTION_INIT }

SUNDER_API void sunder_support_init(sunder_support* support);
SUNDER_API sunder_status sunder_scene_add_support(sunder_scene scene,
                                                  const sunder_support* support);

typedef int32_t sunder_instrument_kind;
enum {
  SUNDER_FORCE = 0,         ///< expansion: a total force in equal parts on its nodes
  SUNDER_DISPLACEMENT = 1,  ///< expansion: a grip that moves its nodes along `axes`
  SUNDER_PRESSURE = 2       ///< presses on a face of a crack (method.md 7)
};
enum { SUNDER_SIDE_UPPER = 0, SUNDER_SIDE_LOWER = 1 };

typedef struct sunder_instrument {
  uint32_t struct_size;
  sunder_instrument_kind kind;
  const char* name;        ///< unique; null: its index
  sunder_selection nodes;  ///< unused by SUNDER_PRESSURE
  double value[3];         ///< force [N] or displacement [mm]
  uint32_t axes;           ///< SUNDER_DISPLACEMENT: held axes
  int32_t side;            ///< SUNDER_PRESSURE: SUNDER_SIDE_*
  int32_t crack;           ///< SUNDER_PRESSURE: id
  int32_t has_ramp;        ///< 0: acts fully from the start
  double at[3];            ///< SUNDER_PRESSURE: the pressed place [mm]
  double ramp[2];          ///< scene times of no and full action; time of step i of N is (i + 1)/N
  double turn[3];          ///< of a rigid grip: rotation vector about its nodes' centroid [deg]
  int32_t rigid;           ///< SUNDER_DISPLACEMENT: 1: its nodes move as one solid
  int32_t reserved;
} sunder_instrument;

#define SUNDER_INSTRUMENT_INIT                                                       \
  {                                                                                  \
    sizeof(sunder_instrument), SUNDER_FORCE, NULL, SUNDER_SELECTION_INIT, {0, 0, 0}, \
        SUNDER_AXES_ALL, SUNDER_SIDE_UPPER, 0, 0, {0, 0, 0}, {0, 0}, {0, 0, 0}, 0, 0 \
  }

SUNDER_API void sunder_instrument_init(sunder_instrument* instrument);
/// `index` (may be null) receives 0, 1, ...
SUNDER_API sunder_status sunder_scene_add_instrument(sunder_scene scene,
                                                     const sunder_instrument* instrument,
                                                     int32_t* index);

/// A crack that is there from the start. Edge crack: a mouth and one tip; internal: two tips.
typedef struct sunder_preset_crack {
  uint32_t struct_size;
  int32_t has_mouth;
  sunder_selection elements;  ///< by ids or box
  double mouth[3];
  double tips[2][3];  ///< the second only without mouth
} sunder_preset_crack;

#define SUNDER_PRESET_CRACK_INIT                                        \
  {                                                                     \
    sizeof(sunder_preset_crack), 0, SUNDER_SELECTION_INIT, {0, 0, 0}, { \
      {0, 0, 0}, { 0, 0, 0 }                                            \
    }                                                                   \
  }

SUNDER_API void sunder_preset_crack_init(sunder_preset_crack* crack);
SUNDER_API sunder_status sunder_scene_add_crack(sunder_scene scene,
                                                const sunder_preset_crack* crack);
/// Elements (by ids or box) taken out before the first solve of a step (0-based): a cut.
SUNDER_API sunder_status sunder_scene_add_removal(sunder_scene scene, int32_t step,
                                                  const sunder_selection* elements);

enum {
  SUNDER_FRACTURE_NONE = 0,
  SUNDER_FRACTURE_A = 1,
  SUNDER_FRACTURE_B = 2,
  SUNDER_FRACTURE_P = 3
};
enum { SUNDER_YIELD_MAX_SHEAR = 0, SUNDER_YIELD_TRESCA = 1 };
enum { SUNDER_SIGMA0_LINE = 0, SUNDER_SIGMA0_TIP = 1, SUNDER_SIGMA0_PRESENT = 2 };
enum { SUNDER_LENGTH_PATH = 0, SUNDER_LENGTH_TOOL = 1 };
enum { SUNDER_BIRTH_ELEMENT = 0, SUNDER_BIRTH_THROUGH = 1 };
enum { SUNDER_SIF_FORMULA = 0, SUNDER_SIF_FIELD = 1 };
enum { SUNDER_CRACK_DESTROYED = 0, SUNDER_CRACK_SPLIT = 1 };
enum { SUNDER_STRESS_CAUCHY = 0, SUNDER_STRESS_BIOT = 1 };

/// docs/method.md says what each reading means.
typedef struct sunder_fracture_options {
  uint32_t struct_size;
  int32_t model;          ///< none (default), A: maximum shear stress, B: with stress intensity,
                          ///< P: largest principal stress
  double alpha;           ///< remaining share of a destroyed element's stiffness, 1e-6
  int32_t yield_measure;  ///< SUNDER_YIELD_*
  int32_t sigma0;         ///< SUNDER_SIGMA0_*
  int32_t crack_length;   ///< SUNDER_LENGTH_*
  int32_t birth;          ///< SUNDER_BIRTH_*
  int32_t sif;            ///< SUNDER_SIF_*
  int32_t max_events;     ///< of one step, 10000
  int32_t has_plane_normal;
  int32_t attribution;  ///< 1: say which instrument broke an element; one more solve an event
  double plane_normal[3];
  double averaging;  ///< radius of the mean that strength is judged by [mm], 0: by element
  int32_t stress;    ///< SUNDER_STRESS_*: what laws but linear call stress
  int32_t crack;     ///< SUNDER_CRACK_*: what a crack of model B leaves
  int32_t
      max_new_nodes;  ///< with SUNDER_CRACK_SPLIT: how many may come; 0: as many as the mesh has
  int32_t contact;    ///< with SUNDER_CRACK_SPLIT: 1 keeps the lips of cracks apart
} sunder_fracture_options;

#define SUNDER_FRACTURE_OPTIONS_INIT                                                             \
  {                                                                                              \
    sizeof(sunder_fracture_options), SUNDER_FRACTURE_NONE, 1e-6, SUNDER_YIELD_MAX_SHEAR,         \
        SUNDER_SIGMA0_LINE, SUNDER_LENGTH_PATH, SUNDER_BIRTH_ELEMENT, SUNDER_SIF_FORMULA, 10000, \
        0, 0, {0, 0, 0}, 0, SUNDER_STRESS_CAUCHY, SUNDER_CRACK_DESTROYED, 0, 0                   \
  }

SUNDER_API void sunder_fracture_options_init(sunder_fracture_options* options);
SUNDER_API sunder_status sunder_scene_set_fracture(sunder_scene scene,
                                                   const sunder_fracture_options* options);

enum {
  SUNDER_ROUTE_AUTO = 0,
  SUNDER_ROUTE_INVERSE = 1,
  SUNDER_ROUTE_CONDENSED = 2,
  SUNDER_ROUTE_FACTOR = 3,
  SUNDER_ROUTE_CG = 4
};
enum { SUNDER_UPDATE_AUTO = 0, SUNDER_UPDATE_EAGER = 1, SUNDER_UPDATE_DEFERRED = 2 };
enum { SUNDER_PRECISION_AUTO = 0, SUNDER_PRECISION_FP32 = 1, SUNDER_PRECISION_FP64 = 2 };

typedef struct sunder_solver_options {
  uint32_t struct_size;
  sunder_backend backend;
  int32_t device;  ///< index among the backend's devices; -1: it chooses
  int32_t route;
  int32_t update;
  int32_t precision;
  double tolerance;        ///< promised relative stress error of every frame, 1e-4
  int32_t no_preparation;  ///< 1: prepare no fracture after a quiet step; no result depends on it
  int32_t reserved;
  double max_ms;  ///< a step ends after the event that found it so long [ms], 0: none
} sunder_solver_options;

#define SUNDER_SOLVER_OPTIONS_INIT                                                                 \
  {                                                                                                \
    sizeof(sunder_solver_options), SUNDER_BACKEND_AUTO, -1, SUNDER_ROUTE_AUTO, SUNDER_UPDATE_AUTO, \
        SUNDER_PRECISION_AUTO, 1e-4, 0, 0, 0                                                       \
  }

SUNDER_API void sunder_solver_options_init(sunder_solver_options* options);
SUNDER_API sunder_status sunder_scene_set_solver(sunder_scene scene,
                                                 const sunder_solver_options* options);
/// Number of steps, at least 1 (default 1). INT32_MAX for a host that decides when to stop.
SUNDER_API sunder_status sunder_scene_set_steps(sunder_scene scene, int32_t steps);
/// On all of the body [mm/s^2], default 0. Materials need a density.
SUNDER_API sunder_status sunder_scene_set_gravity(sunder_scene scene, const double gravity[3]);

/// Motion: each step is one of time. Materials need a density; supports and instruments may be
/// absent. docs/method.md "Motion".
typedef struct sunder_dynamics {
  uint32_t struct_size;
  int32_t max_iterations;    ///< of a step; 0: as many as the tolerance takes
  double time_step;          ///< [s], above 0; scene time 1 is all steps of that length
  double mass_damping;       ///< force per mass and velocity [1/s]
  double stiffness_damping;  ///< stress per small-strain stiffness and strain rate [s]
  int32_t felt_inertia;      ///< 1: a grip's force includes what accelerates its own nodes
  int32_t reserved;
} sunder_dynamics;

#define SUNDER_DYNAMICS_INIT \
  { sizeof(sunder_dynamics), 0, 0, 0, 0, 0, 0 }

SUNDER_API void sunder_dynamics_init(sunder_dynamics* dynamics);
/// Null: statics, the default.
SUNDER_API sunder_status sunder_scene_set_dynamics(sunder_scene scene,
                                                   const sunder_dynamics* dynamics);
/// Whether a host may grasp, remove elements and cut at any time (default 0). Needed where the
/// scene has neither a fracture model nor removals. Where nothing breaks by itself, frames of route
/// condensed compute the fields of all of the body then; else those of what the scene names.
SUNDER_API sunder_status sunder_scene_set_live(sunder_scene scene, int32_t live);
/// Whether stress is wanted (default 1). With 0 it is left out unless the fracture model needs it.
SUNDER_API sunder_status sunder_scene_set_stress(sunder_scene scene, int32_t wanted);

/* ---- Plan: what a scene needs, before it runs ------------------------------------------------ */

typedef struct sunder_plan_handle* sunder_plan;

typedef struct sunder_engine {
  uint32_t struct_size;
  sunder_backend backend;
  int64_t nodes, tets;    ///< of the body: the mesh's, and what its interfaces add
  int64_t unknowns;       ///< degrees of freedom that no support holds
  uint64_t memory_bytes;  ///< that the solver holds
  char device[256];
  char driver[256];
  char precision[32];
  char route[32];
  char update[32];
  char why[512];  ///< why this route
} sunder_engine;

#define SUNDER_ENGINE_INIT \
  { sizeof(sunder_engine), SUNDER_BACKEND_AUTO, 0, 0, 0, 0, "", "", "", "", "", "" }

/// Checks the scene and sets up its solver to tell what it takes; nothing of it stays.
SUNDER_API sunder_status sunder_plan_create(sunder_scene scene, sunder_plan* plan);
SUNDER_API sunder_status sunder_plan_destroy(sunder_plan plan);
SUNDER_API sunder_status sunder_plan_engine(sunder_plan plan, sunder_engine* engine);
/// How many buffers the solver holds, how many parts are left out as the scene does not need them.
SUNDER_API sunder_status sunder_plan_counts(sunder_plan plan, int32_t* buffers, int32_t* left_out);
SUNDER_API sunder_status sunder_plan_buffer(sunder_plan plan, int32_t index, uint64_t* bytes,
                                            char* name, size_t capacity, size_t* length);
SUNDER_API sunder_status sunder_plan_left_out(sunder_plan plan, int32_t index, char* text,
                                              size_t capacity, size_t* length);

/* ---- Simulation ------------------------------------------------------------------------------ */

typedef struct sunder_simulation_handle* sunder_simulation;

enum { SUNDER_LOG_INFO = 0, SUNDER_LOG_WARNING = 1, SUNDER_LOG_ERROR = 2 };
typedef void (*sunder_log_function)(void* user, int32_t level, const char* text);

enum { SUNDER_PHASE_CHECK = 0, SUNDER_PHASE_PREPARE = 1, SUNDER_PHASE_STEP = 2 };
/// Filled by the library, whose struct_size it has.
typedef struct sunder_progress {
  uint32_t struct_size;
  int32_t phase;  ///< of creation: check the scene, prepare the solver; then steps
  int32_t step, steps;
  int32_t events;     ///< of this step, so far
  int32_t destroyed;  ///< elements, so far
} sunder_progress;
/// Called before each phase of creation and after each event of a step. Another value than 0
/// cancels: creation fails, a step ends after that event, with SUNDER_ERROR_CANCELLED.
typedef int32_t (*sunder_progress_function)(void* user, const sunder_progress* progress);

typedef struct sunder_callbacks {
  uint32_t struct_size;
  uint32_t reserved;
  sunder_log_function log;  ///< null: silent
  void* log_user;
  sunder_progress_function progress;  ///< null: none
  void* progress_user;
} sunder_callbacks;

#define SUNDER_CALLBACKS_INIT \
  { sizeof(sunder_callbacks), 0, NULL, NULL, NULL, NULL }

/// Checks the scene and prepares its solver. The scene may be destroyed or changed afterwards.
/// `callbacks` may be null; the struct is copied.
SUNDER_API sunder_status sunder_simulation_create(sunder_scene scene,
                                                  const sunder_callbacks* callbacks,
                                                  sunder_simulation* simulation);
/// At any moment, within 50 ms: no callback runs any more once it has returned. A call that is in
/// work on another thread ends at its next event or solution, as SUNDER_ERROR_CANCELLED or with
/// what it has found, and takes what it uses with it. SUNDER_ERROR_BUSY, and nothing changes: from
/// within a callback, or while one does not return; on a lent device, which must not be used any
/// more afterwards, while any call is in work: cancel it and try again.
SUNDER_API sunder_status sunder_simulation_destroy(sunder_simulation simulation);
SUNDER_API sunder_status sunder_simulation_engine(sunder_simulation simulation,
                                                  sunder_engine* engine);

typedef struct sunder_step {
  uint32_t struct_size;
  int32_t step;        ///< its number, from 0
  double load_factor;  ///< scene time
  int32_t events;      ///< of this step
  int32_t destroyed;   ///< elements, in total
  int32_t iterations;  ///< of conjugate gradients, where they ran
  int32_t polished;    ///< 1: a frame was over the tolerance and was refined
  double compliance;   ///< work of the instruments [N mm]
  double residual;     ///< |f - K u| / |f|
  double error;        ///< estimate of the relative stress error
  double max_yield_ratio;
  double ms_load, ms_solve, ms_stress, ms_decide, ms_update, ms_total;
  double strain_max;        ///< principal strain of live tissue largest in magnitude, with its sign
  double rotation_max_deg;  ///< largest rotation of live tissue [deg]
  int32_t inverted;         ///< live elements turned inside out
  int32_t measured;         ///< 1: these three are; 0: stress was left out
  int32_t back_solves;      ///< applications of the base, those of conjugate gradients left out
  int32_t unfinished;       ///< 1: not at rest: nothing was decided, the next step goes on from it
  int32_t moves;            ///< 1: in motion; else what follows is 0
  int32_t capped;           ///< 1: ended by max_iterations: `error` is over what was promised
  double time;              ///< [s]
  double kinetic, strain_energy;  ///< [N mm]
  /// By forces, grips and gravity since the start; of it lost by damping, by the scheme in time and
  /// with what broke: work = kinetic + strain_energy + dissipated [N mm].
  double work, dissipated;
  double momentum[3];          ///< [t mm/s]
  double angular_momentum[3];  ///< about the origin [t mm^2/s]
  int32_t out_of_time;         ///< 1: ended by time: what was still to break is left to the next
  /// New bases (factors or inverses of the body as it is) that this step and what was done since
  /// the one before went over to: grips, cuts, removals, going back. 0 up to the damage at which
  /// `plan` says that a new one is cheaper, and by law linear for every grip.
  int32_t new_bases;
  double ms_new_bases;  ///< how long the step and those calls waited for them
} sunder_step;

#define SUNDER_STEP_INIT                                                                         \
  {                                                                                              \
    sizeof(sunder_step), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, \
        0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, 0, 0, 0                                             \
  }

/// Computes the next step: loads, displacement, stress, decision, update, until nothing breaks.
/// `step` may be null. SUNDER_ERROR_ORDER when all steps are done. SUNDER_ERROR_CANCELLED: the step
/// ended early, counts as done, and its results can be read. SUNDER_ERROR_NUMERICAL: the results of
/// the last good solve can be read.
SUNDER_API sunder_status sunder_simulation_step(sunder_simulation simulation, sunder_step* step);
/// In motion: the next step, of dt [s] in place of the scene's. SUNDER_ERROR_ORDER in statics.
SUNDER_API sunder_status sunder_simulation_step_by(sunder_simulation simulation, double dt,
                                                   sunder_step* step);
/// Ends the running step after its current event. Any thread, any time. When nothing breaks in it
/// any more, or no step is running: the next step in which something breaks.
SUNDER_API sunder_status sunder_simulation_cancel(sunder_simulation simulation);
/// Drives an instrument by hand from the next step on: force [N] or displacement [mm], in place of
/// its value and ramp.
SUNDER_API sunder_status sunder_simulation_drive(sunder_simulation simulation, int32_t instrument,
                                                 const double value[3]);
/// Turns a rigid grip by hand from the next step on: rotation vector about the centroid of its
/// undeformed nodes [deg], in place of its turn and ramp. SUNDER_ERROR_VALUE for any other
/// instrument.
SUNDER_API sunder_status sunder_simulation_turn(sunder_simulation simulation, int32_t instrument,
                                                const double turn[3]);

/* Fields of the last solve. Zero before the first step. `nodes` and `tets` are those of the mesh,
   and with interfaces of the body that they make of it (sunder_scene_add_interface). */

/// (nodes x 3), size 3 * nodes [mm].
SUNDER_API sunder_status sunder_simulation_displacement(sunder_simulation simulation,
                                                        double* values, size_t size);
/// (nodes x 3), size 3 * nodes [mm/s]. SUNDER_ERROR_ORDER in statics.
SUNDER_API sunder_status sunder_simulation_velocity(sunder_simulation simulation, double* values,
                                                    size_t size);
/// The body goes on with these, (nodes x 3), size 3 * nodes [mm/s]; what supports hold stays.
/// SUNDER_ERROR_ORDER in statics.
SUNDER_API sunder_status sunder_simulation_set_velocity(sunder_simulation simulation,
                                                        const double* values, size_t size);
/// (tets x 6), Voigt order xx yy zz xy yz zx, size 6 * tets [MPa]; alpha times that where
/// destroyed. SUNDER_ERROR_ORDER when stress was left out.
SUNDER_API sunder_status sunder_simulation_stress(sunder_simulation simulation, double* values,
                                                  size_t size);
/// (tets): maximum shear stress [MPa].
SUNDER_API sunder_status sunder_simulation_max_shear(sunder_simulation simulation, double* values,
                                                     size_t size);
/// (tets): yield measure over yield stress; 0 where unbreakable or destroyed.
SUNDER_API sunder_status sunder_simulation_yield_ratio(sunder_simulation simulation, double* values,
                                                       size_t size);
/// (tets): 1 where destroyed.
SUNDER_API sunder_status sunder_simulation_destroyed(sunder_simulation simulation, uint8_t* values,
                                                     size_t size);
/// (instruments x 3): force of each instrument on the body [N]. Zero before the first step.
SUNDER_API sunder_status sunder_simulation_reactions(sunder_simulation simulation, double* values,
                                                     size_t size);
/// (3): force of the supports on the body [N]. SUNDER_ERROR_ORDER before the first step.
SUNDER_API sunder_status sunder_simulation_support_reaction(sunder_simulation simulation,
                                                            double* values, size_t size);

/* Forces of the grips between frames, for a haptic device. */

/// For a thread of its own: a call neither waits for a step nor makes one wait. Belongs to no other
/// call's handle, so a step does not make it busy. Outlives the simulation, to say that it is gone.
typedef struct sunder_grips_handle* sunder_grips;

/// One handle a simulation at a time. SUNDER_ERROR_ORDER: the scene has no grip, or there is a
/// handle already. SUNDER_ERROR_DEVICE: this backend, route or update has nothing of the kind.
SUNDER_API sunder_status sunder_grips_create(sunder_simulation simulation, sunder_grips* grips);
SUNDER_API sunder_status sunder_grips_destroy(sunder_grips grips);
/// Force of each grip on the body [N] if it were at a displacement [mm], by the body as the last
/// solve left it. Both (instruments x 3), size 3 * instruments; what is no grip, or an axis that it
/// leaves free, is not read and has force 0. With the displacements of that solve: its reactions.
/// Never other than finite. The forces are 0 with SUNDER_ERROR_ORDER: before the first solve;
/// SUNDER_ERROR_VALUE: a displacement is not finite, or so large that a force would not be;
/// SUNDER_ERROR_HANDLE: the simulation was destroyed, and this handle is there to be destroyed too.
SUNDER_API sunder_status sunder_grips_forces(sunder_grips grips, const double* displacements,
                                             double* forces, size_t size);

/* The body as interfaces make it at creation (sunder_scene_add_interface), or as split cracks leave
   it (SUNDER_CRACK_SPLIT). Nodes and elements keep their ids for ever; nodes that come have ids
   after the mesh's own, and elements get other corners. All arrays above have the size that the
   body had at creation: with split cracks displacements are those of the mesh's own nodes. Without
   either what follows says what the mesh says. */

typedef struct sunder_body {
  uint32_t struct_size;
  int32_t version;           ///< another one whenever what follows, or a corner, has changed
  int32_t node_count;        ///< of the mesh, and those that have come
  int32_t tet_count;         ///< as at creation: of the mesh, and those of its interfaces
  int32_t crack_face_count;  ///< open faces
  int32_t reserved;
} sunder_body;

#define SUNDER_BODY_INIT \
  { sizeof(sunder_body), 0, 0, 0, 0, 0 }

SUNDER_API sunder_status sunder_simulation_body(sunder_simulation simulation, sunder_body* body);
/// (node_count x 3), size 3 * node_count: where each node lies undeformed [mm].
SUNDER_API sunder_status sunder_simulation_body_nodes(sunder_simulation simulation, double* values,
                                                      size_t size);
/// (tets x 4): nodes of each element now, in the order of its corners in the mesh. Size 4 * tets.
SUNDER_API sunder_status sunder_simulation_body_corners(sunder_simulation simulation,
                                                        int32_t* values, size_t size);
/// (node_count): the mesh's node that lies where each node lies, of an interface's copy the one
/// that it was made of; its own id for the mesh's own.
SUNDER_API sunder_status sunder_simulation_body_parents(sunder_simulation simulation,
                                                        int32_t* values, size_t size);
/// (node_count x 3), size 3 * node_count [mm]. Zero before the first step.
SUNDER_API sunder_status sunder_simulation_body_displacement(sunder_simulation simulation,
                                                             double* values, size_t size);
/// (crack_face_count x 7), size 7 * crack_face_count: the crack's id, three nodes of the lip left
/// of its path (seen from above), and those of the right lip that lay at the same places. Where the
/// two are one node the face ends in tissue that holds: the crack's front.
SUNDER_API sunder_status sunder_simulation_crack_faces(sunder_simulation simulation,
                                                       int32_t* values, size_t size);

/* What broke, and why. */

enum {
  SUNDER_CAUSE_MSS = 0,
  SUNDER_CAUSE_SIF = 1,
  SUNDER_CAUSE_PRESET = 2,
  SUNDER_CAUSE_SCRIPT = 3,
  SUNDER_CAUSE_PRINCIPAL = 4,
  SUNDER_CAUSE_INTERFACE = 5  ///< the law of an interface, by which its faces part
};

/// One destroyed element, or one growth or birth of a split crack. `order` counts them over the
/// whole run, as the index does.
typedef struct sunder_event {
  uint32_t struct_size;
  int32_t order;
  int32_t step;
  int32_t event;            ///< one decision with one update; several elements may share it
  int32_t element;          ///< with `lives`: that asked for a new crack; -1: one has grown
  int32_t cause;            ///< SUNDER_CAUSE_*: which hypothesis
  int32_t crack;            ///< id; -1: none
  int32_t instrument;       ///< with the largest share of its maximum shear stress, or the id of a
                            ///< grip or a push; -1: not known
  double instrument_share;  ///< that share of the whole; 0: not known
  double load_factor;
  double ratio;  ///< mss, principal: measure / yield; sif: r_e / max(rho, h/2) or K / K_c;
                 ///< interface: traction / strength (docs/method.md "Interfaces"); else 0
  int32_t has_sif;
  int32_t tip;                ///< with has_sif: which tip of the crack
  double k, k_a, k_b, k_c;    ///< Eq. 2 to 4 [MPa sqrt(mm)]
  double theta;               ///< of growth [deg]
  double reach;               ///< r_e [mm]; 0 where the material's toughness decided
  double sigma0, beta, a, b;  ///< [MPa], [deg], [mm], [mm]
  double k_1, k_2;            ///< from the field; 0 with SUNDER_SIF_FORMULA
  double toughness;           ///< K_c of the element [MPa sqrt(mm)]; 0: none
  double advance;             ///< of the tip in this event [mm]
  int32_t lives;              ///< 1: a crack has split, nothing was destroyed
  int32_t reserved;
  double energy;  ///< interface: that parting has taken [N mm]; else 0
} sunder_event;

#define SUNDER_EVENT_INIT                                                                         \
  {                                                                                               \
    sizeof(sunder_event), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, \
        0, 0, 0, 0, 0                                                                             \
  }

SUNDER_API sunder_status sunder_simulation_event_count(sunder_simulation simulation,
                                                       int32_t* count);
SUNDER_API sunder_status sunder_simulation_event_at(sunder_simulation simulation, int32_t index,
                                                    sunder_event* event);

enum { SUNDER_CRACK_EDGE = 0, SUNDER_CRACK_INTERNAL = 1 };

/// Geometry in space, at mid-thickness of the undeformed body [mm].
typedef struct sunder_crack {
  uint32_t struct_size;
  int32_t id;
  int32_t kind;
  int32_t tip_count;      ///< 1 (edge) or 2
  int32_t path_count;     ///< points of the path, from the mouth or first tip
  int32_t element_count;  ///< destroyed elements that belong to it
  int32_t tip_ended[2];
  double mouth[3];  ///< edge cracks
  double tips[2][3];
  double directions[2][3];  ///< unit, forward
  double length;            ///< of the path
} sunder_crack;

#define SUNDER_CRACK_INIT                                                           \
  {                                                                                 \
    sizeof(sunder_crack), 0, 0, 0, 0, 0, {0, 0}, {0, 0, 0}, {{0, 0, 0}, {0, 0, 0}}, \
        {{0, 0, 0}, {0, 0, 0}}, 0                                                   \
  }

SUNDER_API sunder_status sunder_simulation_crack_count(sunder_simulation simulation,
                                                       int32_t* count);
SUNDER_API sunder_status sunder_simulation_crack_at(sunder_simulation simulation, int32_t index,
                                                    sunder_crack* crack);
/// (path_count x 3), size 3 * path_count.
SUNDER_API sunder_status sunder_simulation_crack_path(sunder_simulation simulation, int32_t index,
                                                      double* values, size_t size);
/// (element_count), in the order of destruction.
SUNDER_API sunder_status sunder_simulation_crack_elements(sunder_simulation simulation,
                                                          int32_t index, int32_t* values,
                                                          size_t size);

enum {
  SUNDER_TIP_K = 1,
  SUNDER_TIP_THETA = 2,
  SUNDER_TIP_MODES = 4,  ///< k_1, k_2, k_3
  SUNDER_TIP_J = 8,
  SUNDER_TIP_TOUGHNESS = 16
};

/// A tip as the last solve leaves it, whether it grows or rests.
typedef struct sunder_tip {
  uint32_t struct_size;
  int32_t crack;
  int32_t tip;              ///< which tip of the crack
  int32_t ended;            ///< 1: nothing drives it any more
  int32_t known;            ///< a sum of SUNDER_TIP_*: what is there; all else is 0
  int32_t plane_strain;     ///< of toughness: 1: plane strain round the tip, 0: plane stress
  double position[3];       ///< undeformed, at mid-thickness [mm]
  double k;                 ///< >= 0, by what drives the tips [MPa sqrt(mm)]
  double theta;             ///< of growth [deg]
  double k_1, k_2, k_3, j;  ///< by the field [MPa sqrt(mm)], [N/mm]
  double toughness;         ///< K_c of what lies ahead [MPa sqrt(mm)]: it grows when k reaches it
  char field_note[32];      ///< what disturbs the field's K (docs/interface.md); "": nothing
} sunder_tip;

#define SUNDER_TIP_INIT \
  { sizeof(sunder_tip), 0, 0, 0, 0, 0, {0, 0, 0}, 0, 0, 0, 0, 0, 0, 0, "" }

/// Measures all tips, by crack and tip, and tells how many there are. 0 before the first step and
/// without cracks.
SUNDER_API sunder_status sunder_simulation_measure_tips(sunder_simulation simulation,
                                                        int32_t* count);
/// One of those last measured.
SUNDER_API sunder_status sunder_simulation_tip_at(sunder_simulation simulation, int32_t index,
                                                  sunder_tip* tip);

/// An interface and how far it has parted.
typedef struct sunder_interface {
  uint32_t struct_size;
  int32_t materials[2];   ///< between whose elements it lies
  int32_t first_element;  ///< of its own
  int32_t element_count;
  int32_t reserved;
  double strength, energy, shear_ratio;  ///< as it was added
  double stiffness;                      ///< traction per opening [N/mm^3]
  double opening;                        ///< at which it parts in tension [mm]
  double thickness;                      ///< of its elements [mm]
  double area;                           ///< [mm^2]
  double parted;                         ///< of that, by its law or as its elements were taken out
  double spent;                          ///< energy that parting by its law has taken [N mm]
} sunder_interface;

#define SUNDER_INTERFACE_INIT \
  { sizeof(sunder_interface), {0, 0}, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

SUNDER_API sunder_status sunder_simulation_interface_count(sunder_simulation simulation,
                                                           int32_t* count);
/// In the order in which they were added.
SUNDER_API sunder_status sunder_simulation_interface_at(sunder_simulation simulation, int32_t index,
                                                        sunder_interface* state);

SUNDER_API sunder_status sunder_simulation_warning_count(sunder_simulation simulation,
                                                         int32_t* count);
SUNDER_API sunder_status sunder_simulation_warning_at(sunder_simulation simulation, int32_t index,
                                                      char* text, size_t capacity, size_t* length);

/* ---- A live body: grasp, cut, go back and forth, draw (docs/embedding.md "A live body") -------
 */

/// The next step with a bound on its time in place of that of the solver options: once max_ms [ms]
/// have passed at the end of an event, the step ends with the solution that follows, as
/// `out_of_time`; what is still to break is left to the next one. 0: none.
SUNDER_API sunder_status sunder_simulation_step_within(sunder_simulation simulation, double max_ms,
                                                       sunder_step* step);
/// Before the first step: does once what a step does first, and solves for loads that span what the
/// instruments can do, whichever way they are driven, so that the first step costs what the second
/// does. Later results are as accurate as those of a cold simulation, but may differ by rounding; a
/// history takes it down, so that what is done again has the same bits. Nothing later on, in motion
/// and by the laws of finite deformation.
SUNDER_API sunder_status sunder_simulation_warm_up(sunder_simulation simulation);

/// Takes live elements out between two steps, by one event with SUNDER_CAUSE_SCRIPT. In statics,
/// after the first step, fields and forces are those of the new body at once, under the same load.
/// SUNDER_ERROR_ORDER, and nothing changes: an element that is not there, named twice, gone
/// already; nothing can be removed (sunder_scene_set_live).
SUNDER_API sunder_status sunder_simulation_remove(sunder_simulation simulation,
                                                  const int32_t* elements, size_t count);
/// Removes the live elements that a blade has passed: those whose inside, as it is now, any of the
/// triangles meets. (triangles x 3 x 3) [mm], size 9 * triangles; two places of a blade's edge one
/// after the other make two. `removed`, how many, may be null. Where cracks split nothing is
/// removed: faces between live elements on both sides of the blade open, as a crack whose tips
/// later steps may drive, and `removed` is their number. SUNDER_ERROR_ORDER, and nothing changes,
/// for a blade that lies along the board's plane there, or more new nodes than may come.
SUNDER_API sunder_status sunder_simulation_cut(sunder_simulation simulation, const double* swept,
                                               size_t size, int32_t* removed);

/// Says which elements may soon be removed, cut or grasped, the likeliest first, in place of those
/// named before (count 0: none). What the route needs for the first 128 of them is brought to hand:
/// on route condensed, where some lie beyond its region, by a thread, for some 85 nodes; on route
/// factor of the CPU, and inverse once a factor has taken its place, at once and again in quiet
/// steps after an event; elsewhere there is nothing. No result changes by a bit.
/// SUNDER_ERROR_ORDER, and nothing changes: an element that is not there; nothing can be removed
/// (sunder_scene_set_live).
SUNDER_API sunder_status sunder_simulation_prepare(sunder_simulation simulation,
                                                   const int32_t* elements, size_t count);
/// The same of the live elements with a corner within a radius [mm] of a place now, the nearest
/// first. `count`, how many there are, may be null. It reads where all nodes are, which on route
/// condensed takes a solve with the factor.
SUNDER_API sunder_status sunder_simulation_prepare_near(sunder_simulation simulation,
                                                        const double near[3], double radius,
                                                        int32_t* count);

/// Takes hold of nodes where they are now, on all axes: nothing moves by it. `rigid` 1: they move
/// as one solid, which may turn, about its place, the mean of theirs; 0: as points that all go the
/// same way. `grip`: its id, after the indices of the scene's instruments; none comes twice.
/// SUNDER_ERROR_ORDER, and nothing changes: a node that is not there, named twice, held by a
/// support or another grip, or of which all elements are gone; nothing can be removed
/// (sunder_scene_set_live), or this backend and route hold no more nodes (the sentence names one
/// that does).
SUNDER_API sunder_status sunder_simulation_grasp(sunder_simulation simulation, const int32_t* nodes,
                                                 size_t count, int32_t rigid, int32_t* grip);
/// The same of all nodes that are within a radius [mm] of a place now and could be grasped; that is
/// the grip's place. SUNDER_ERROR_ORDER where there are none.
SUNDER_API sunder_status sunder_simulation_grasp_near(sunder_simulation simulation,
                                                      const double near[3], double radius,
                                                      int32_t rigid, int32_t* grip);
/// Which nodes it holds. `count` is how many; they are written where `capacity` is enough, else
/// SUNDER_ERROR_SIZE. `nodes` may be null with capacity 0.
SUNDER_API sunder_status sunder_simulation_held_nodes(sunder_simulation simulation, int32_t grip,
                                                      int32_t* nodes, size_t capacity,
                                                      size_t* count);
/// Where it is [mm].
SUNDER_API sunder_status sunder_simulation_grip_place(sunder_simulation simulation, int32_t grip,
                                                      double position[3]);
/// Brings a grip to a place [mm] and a rotation since it took hold, from the next step on.
/// `quaternion` (x, y, z, w), of any length above 0; null: no rotation. SUNDER_ERROR_ORDER, as of
/// all functions of a grip or a push: it is not there, or has been let go; of points that would
/// turn.
SUNDER_API sunder_status sunder_simulation_pose(sunder_simulation simulation, int32_t grip,
                                                const double position[3],
                                                const double quaternion[4]);
/// What a grip exerts on the body in the last solve: force [N], and torque about its place [N mm].
/// Zero before the first solve since it took hold.
SUNDER_API sunder_status sunder_simulation_wrench(sunder_simulation simulation, int32_t grip,
                                                  double force[3], double torque[3]);
/// Lets go: from the next step on the body is as if it had never been held there. A grip of the
/// scene, by its instrument's number, lets go for good: its reaction is zero, it cannot be driven
/// any more (SUNDER_ERROR_ORDER), and its nodes can be grasped. SUNDER_ERROR_ORDER, with the
/// reason: it is no grip, or in statics grips of the scene alone hold the body, or a crack of split
/// nodes has reached one of its.
SUNDER_API sunder_status sunder_simulation_release(sunder_simulation simulation, int32_t grip);
/// A force [N] in equal parts on nodes, from the next step on until it is dropped. `push`: an id as
/// of a grip. SUNDER_ERROR_ORDER, and nothing changes: a node that is not there, named twice or
/// held on all axes by a support.
SUNDER_API sunder_status sunder_simulation_push(sunder_simulation simulation, const int32_t* nodes,
                                                size_t count, const double force[3], int32_t* push);
/// A push acts on these nodes, with this force, from the next step on.
SUNDER_API sunder_status sunder_simulation_move(sunder_simulation simulation, int32_t push,
                                                const int32_t* nodes, size_t count,
                                                const double force[3]);
/// A push ends.
SUNDER_API sunder_status sunder_simulation_drop(sunder_simulation simulation, int32_t push);

/// Keeps what is done from now on, so that it can be undone; before the first step, grip and push.
/// `quick`: the last so many actions that undo stops before are taken back by what the solver has
/// kept of each; others, and all where route or law keep nothing, by doing again what was done
/// before. SUNDER_ERROR_ORDER later on.
SUNDER_API sunder_status sunder_simulation_keep_history(sunder_simulation simulation,
                                                        int32_t quick);
/// How many actions can be taken back and done again.
SUNDER_API sunder_status sunder_simulation_history(sunder_simulation simulation, int32_t* undos,
                                                   int32_t* redos);
/// Takes back the last `actions` of these: steps and removals in which something broke, grips and
/// pushes that came or went; with all that came after, driving and poses included; every later
/// result is bit by bit what it would have been then. `events` that went, and whether it was done
/// by doing again what was done before (`replayed`), may be null. SUNDER_ERROR_ORDER, and nothing
/// changes: there are fewer.
SUNDER_API sunder_status sunder_simulation_undo(sunder_simulation simulation, int32_t actions,
                                                int32_t* events, int32_t* replayed);
/// Does again what was taken back, until the next step or action. `events` that came, may be null.
SUNDER_API sunder_status sunder_simulation_redo(sunder_simulation simulation, int32_t actions,
                                                int32_t* events);
/// Marks the state of now: a number, from 1 on, of this simulation.
SUNDER_API sunder_status sunder_simulation_save(sunder_simulation simulation, int32_t* mark);
/// Comes back to a marked state, from wherever. `replayed` as above. SUNDER_ERROR_VALUE: no such
/// mark.
SUNDER_API sunder_status sunder_simulation_restore(sunder_simulation simulation, int32_t mark,
                                                   int32_t* replayed);
/// Lets a mark and what it holds go.
SUNDER_API sunder_status sunder_simulation_forget(sunder_simulation simulation, int32_t mark);
/// The history as bytes: what was done, not the body. As sunder_error_of() does with a text:
/// `length` is how many there are; they are written where `capacity` is enough, else
/// SUNDER_ERROR_SIZE. `bytes` may be null with capacity 0: then `length` alone is asked for.
SUNDER_API sunder_status sunder_simulation_store(sunder_simulation simulation, void* bytes,
                                                 size_t capacity, size_t* length);
/// Does what such bytes tell, from the beginning. SUNDER_ERROR_INPUT, and nothing changes: damaged,
/// of another version, of another body, scene or solver.
SUNDER_API sunder_status sunder_simulation_load(sunder_simulation simulation, const void* bytes,
                                                size_t length);

/// Where live tissue ends, as triangles.
typedef struct sunder_surface {
  uint32_t struct_size;
  int32_t triangle_count;
  int32_t node_count;  ///< of the body (sunder_simulation_body)
  int32_t reserved;
  uint64_t version;  ///< from 1 on; another one where a triangle has changed
} sunder_surface;

#define SUNDER_SURFACE_INIT \
  { sizeof(sunder_surface), 0, 0, 0, 0 }

/// Follows what has happened since the last call, at a price that grows with it; the first call
/// looks at the whole body.
SUNDER_API sunder_status sunder_simulation_surface(sunder_simulation simulation,
                                                   sunder_surface* surface);

/// In a place of its own, until it goes; then the last one takes its place.
typedef struct sunder_triangle {
  int32_t place;
  int32_t nodes[3];  ///< of the body, anticlockwise seen from outside
  int32_t element;   ///< behind it
  int32_t piece;     ///< that it belongs to, by its first element; -1: the one that is held
  int32_t opened;    ///< 1: a lip of a cut or crack, where the mesh had another element
} sunder_triangle;

/// Triangles, as the last sunder_simulation_surface found them, that have changed or come since a
/// version; 0: all. Those in places from triangle_count on are gone. `count` is how many there are;
/// `triangles` may be null with capacity 0: then that alone is asked for. SUNDER_ERROR_SIZE: more
/// than `capacity`. SUNDER_ERROR_ORDER before the first sunder_simulation_surface.
SUNDER_API sunder_status sunder_simulation_surface_changes(sunder_simulation simulation,
                                                           uint64_t since,
                                                           sunder_triangle* triangles,
                                                           size_t capacity, size_t* count);
/// (node_count x 3) each, size 3 * node_count: where the body's nodes are now [mm] and their unit
/// normals, weighted by area; 0 for nodes inside. Either may be null.
SUNDER_API sunder_status sunder_simulation_surface_points(sunder_simulation simulation,
                                                          float* places, float* normals,
                                                          size_t size);
/// A fine mesh of the host's own, carried by the tetrahedra: (vertices x 3) where its vertices lie
/// in the undeformed body [mm], size 3 * vertices; in place of one before.
SUNDER_API sunder_status sunder_simulation_set_skin(sunder_simulation simulation,
                                                    const double* vertices, size_t size);
/// (vertices x 3), size 3 * vertices: where they are now [mm]. `lives`, (vertices): 0 where the
/// element that carries a vertex is destroyed; may be null. SUNDER_ERROR_ORDER without a skin.
SUNDER_API sunder_status sunder_simulation_skin(sunder_simulation simulation, float* places,
                                                size_t size, uint8_t* lives);

/* ---- Hands and pictures on threads of their own ---------------------------------------------- */

/// Where forces change with a new solution (a rupture), they go from those of the one before to
/// those of the new one within so many milliseconds, both at the present displacement; 0 (the
/// default): at once. A grip that is let go has no force at once, one newly held begins at none.
SUNDER_API sunder_status sunder_grips_blend(sunder_grips grips, double ms);

/// A grip that a host has grasped, between two steps. This struct has no version: it never changes.
typedef struct sunder_hand {
  int32_t grip;          ///< id of sunder_simulation_grasp
  int32_t held;          ///< out: 0, with no force: let go, or no step has been taken with it yet
  double position[3];    ///< in: where the hand has it [mm]
  double quaternion[4];  ///< in: rotation since it took hold (x, y, z, w); of points not read
  double force[3];       ///< out: on the body [N]; on the hand: minus both
  double torque[3];      ///< out: about `position` [N mm]
} sunder_hand;

#define SUNDER_HAND_INIT                                  \
  {                                                       \
    0, 0, {0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0}, { 0, 0, 0 } \
  }

enum {
  SUNDER_FELT_WAITING = 0,  ///< no solution: before the first step, or undone to before it
  SUNDER_FELT_LIVE = 1,
  SUNDER_FELT_GONE = 2,     ///< the simulation was destroyed
  SUNDER_FELT_OVERFLOW = 3  ///< a displacement is not finite, or so large that a force would not be
};

/// What forces come from.
typedef struct sunder_felt {
  uint32_t struct_size;
  int32_t state;      ///< SUNDER_FELT_*
  uint64_t solution;  ///< its number, from 1 on in the order of solutions; a rupture makes several
  int32_t step;       ///< the step it belongs to, from 0 on; -1: unknown
  int32_t reserved;
  double age_ms;  ///< since it was found
  double share;   ///< of it in the forces: below 1 while the one before is blended in
} sunder_felt;

#define SUNDER_FELT_INIT \
  { sizeof(sunder_felt), 0, 0, 0, 0, 0, 0 }

/// sunder_grips_forces with hands that move what a host has grasped: each gets its force and torque
/// there. Those not named stay where the solution has them; so do the scene's grips where
/// `displacements` and `forces` are null with size 0. A few microseconds; nothing is allocated, and
/// no step is waited for. `felt` may be null; it is filled also with SUNDER_ERROR_ORDER (waiting),
/// SUNDER_ERROR_HANDLE (gone) and SUNDER_ERROR_VALUE (overflow), where all forces are 0.
SUNDER_API sunder_status sunder_grips_feel(sunder_grips grips, const double* displacements,
                                           double* forces, size_t size, sunder_hand* hands,
                                           size_t count, sunder_felt* felt);

/// Fields of the last finished frame, for a thread of its own while the next one is computed.
typedef struct sunder_frames_handle* sunder_frames;

enum {
  SUNDER_FRAME_DISPLACEMENT = 1,
  SUNDER_FRAME_STRESS = 2,
  SUNDER_FRAME_YIELD_RATIO = 4,
  SUNDER_FRAME_DESTROYED = 8
};

/// `fields`, a sum of SUNDER_FRAME_*: each costs every step its copy. `nodes`, of which
/// displacement is wanted (on route condensed those of the surface cost little, all of them a
/// solve); null with count 0: all of the body. One handle at a time: a former one says
/// SUNDER_ERROR_HANDLE.
SUNDER_API sunder_status sunder_frames_create(sunder_simulation simulation, uint32_t fields,
                                              const int32_t* nodes, size_t count,
                                              sunder_frames* frames);
SUNDER_API sunder_status sunder_frames_destroy(sunder_frames frames);

typedef struct sunder_frame {
  uint32_t struct_size;
  int32_t step;        ///< that it is the end of, from 0 on; -1: before the first one
  uint64_t number;     ///< another one where something may have changed; from 1 on
  int32_t node_count;  ///< of the body
  int32_t reserved;
} sunder_frame;

#define SUNDER_FRAME_INIT \
  { sizeof(sunder_frame), 0, 0, 0, 0 }

/// Takes the last finished frame: the fields below are its, until the next call.
/// SUNDER_ERROR_HANDLE: the simulation was destroyed, as of the functions below.
SUNDER_API sunder_status sunder_frames_take(sunder_frames frames, sunder_frame* frame);
/// (wanted nodes x 3) [mm], or all of the body: size 3 * node_count. SUNDER_ERROR_ORDER, as of the
/// others: the handle was made without it, or no frame was taken yet.
SUNDER_API sunder_status sunder_frames_displacement(sunder_frames frames, double* values,
                                                    size_t size);
/// (elements x 6) [MPa], as sunder_simulation_stress.
SUNDER_API sunder_status sunder_frames_stress(sunder_frames frames, double* values, size_t size);
/// (elements), as sunder_simulation_yield_ratio.
SUNDER_API sunder_status sunder_frames_yield_ratio(sunder_frames frames, double* values,
                                                   size_t size);
/// (elements), 1 where destroyed.
SUNDER_API sunder_status sunder_frames_destroyed(sunder_frames frames, uint8_t* values,
                                                 size_t size);

/* ---- Fields lent ----------------------------------------------------------------------------- */

typedef int32_t sunder_field;
enum {
  SUNDER_FIELD_DISPLACEMENT = 0,  ///< as sunder_simulation_displacement, and so on
  SUNDER_FIELD_VELOCITY = 1,
  SUNDER_FIELD_STRESS = 2,
  SUNDER_FIELD_MAX_SHEAR = 3,
  SUNDER_FIELD_YIELD_RATIO = 4
};

/// A field in memory of the library's own, in place of an array of the caller's: where it lies
/// (`values`) and how many numbers it has (`size`), in the shape of the function that reads it.
/// Each call brings it up to date; the place of a simulation's field is the same every time. Valid,
/// and unchanged, until the same field is lent again or the simulation is destroyed; a step leaves
/// it as it was. Fails as the function that reads it, and then both are left alone.
SUNDER_API sunder_status sunder_simulation_lend(sunder_simulation simulation, sunder_field field,
                                                const double** values, size_t* size);
/// The same of sunder_simulation_destroyed.
SUNDER_API sunder_status sunder_simulation_lend_destroyed(sunder_simulation simulation,
                                                          const uint8_t** values, size_t* size);

/* ---- Bodies in common ------------------------------------------------------------------------ */

/// What simulations of one intact body share on the CPU: the order of its unknowns, its factor and
/// the dense inverse, made once by the first that needs them. Bodies are the same whose stiffness
/// is: load, yield stress, instruments' places and what breaks may differ. By laws of finite
/// deformation and in motion nothing is shared.
typedef struct sunder_bodies_handle* sunder_bodies;

/// Keeps the bodies asked for last, at most `most` (1 or more); those in use live on.
SUNDER_API sunder_status sunder_bodies_create(int32_t most, sunder_bodies* bodies);
/// Simulations made of it go on.
SUNDER_API sunder_status sunder_bodies_destroy(sunder_bodies bodies);
/// As sunder_simulation_create on the CPU, and no result other by a bit. By any number of threads
/// at once, each with a scene of its own. SUNDER_ERROR_DEVICE where the scene asks for another
/// backend than SUNDER_BACKEND_CPU or SUNDER_BACKEND_AUTO.
SUNDER_API sunder_status sunder_simulation_create_of(sunder_scene scene, sunder_bodies bodies,
                                                     const sunder_callbacks* callbacks,
                                                     sunder_simulation* simulation);

#ifdef __cplusplus
}
#endif
#endif
