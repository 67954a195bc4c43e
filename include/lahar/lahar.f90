!> Fortran interface of lahar, shipped as source: compile it with the program.
!>
!>   gfortran -std=f2018 -O2 include/lahar/lahar.f90 program.f90 -Ltarget/release -llahar
!>
!> Two layers. The types lahar_context, lahar_material, lahar_world and lahar_view with their procedures are for programs.
!> Below them stand the functions of lahar.h with the same names and arguments, where an absent argument is NULL; a function
!> whose name would equal that of a constant has the suffix _function.
!>
!> Every procedure of the upper layer takes `stat` and `errmsg`. Without `stat` an error ends the program with the message.
!> With it the program goes on: `stat` is one of LAHAR_OK, LAHAR_ERROR_...
!>
!> Arrays of vectors are interleaved, position(dimension, count); stresses have the components xx, yy, zz, xy, yz, zx, tension
!> positive. Ids, indices of nodes and particles count from 0 as in C. An object is freed by `free`, not at the end of a scope;
!> freeing in any order is safe. What a function does in detail, its units and errors stand in lahar.h.
module lahar
  use, intrinsic :: iso_c_binding
  implicit none
  private

  !> Kind of real numbers.
  integer, parameter, public :: lahar_real = c_double
  !> Kind of ids, counts and indices.
  integer, parameter, public :: lahar_index = c_int64_t

  ! ---- begin of the part that `cargo xtask headers` writes ----
  integer(c_int32_t), parameter, public :: LAHAR_OK = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_NULL_ARGUMENT = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_STRUCT_SIZE = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_INVALID_ARGUMENT = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_UNKNOWN_NAME = 4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_MISSING_PARAMETER = 5_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_OUT_OF_BOUNDS = 6_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_NOT_FOUND = 7_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_VIEW_OPEN = 8_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_VIEW_STALE = 9_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_BUSY = 10_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_READ_ONLY = 11_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_UNSUPPORTED = 12_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_BUFFER_TOO_SMALL = 13_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_STEP_TOO_LARGE = 100_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_NON_FINITE_INPUT = 101_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_OUTSIDE_GRID = 102_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_SMALLER_STEP = 103_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_MATERIAL_REFUSED = 104_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_CANCELLED = 105_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_FILE = 200_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PLUGIN_NOT_FOUND = 201_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PLUGIN_INVALID = 202_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PLUGIN_ABI = 203_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PLUGIN_REFUSED = 204_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_THREADS = 205_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_OUT_OF_MEMORY = 206_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PANIC = -1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_MATERIAL_FAILED = -2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_NON_FINITE = -3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_POISONED = -4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ERROR_PLUGIN_BROKEN = -5_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_VERSION_MAJOR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_VERSION_MINOR = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_VERSION_PATCH = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ABI_VERSION = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_LOG_ERROR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_LOG_WARNING = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_LOG_INFORMATION = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_LOG_DETAIL = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_SHAPE_LINEAR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_SHAPE_QUADRATIC_BSPLINE = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_SHAPE_CUBIC_BSPLINE = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_SHAPE_UNIFORM_GIMP = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_SHAPE_CONTIGUOUS_GIMP = 4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALLS_PLAIN = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALLS_MODIFIED = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_PIC_FLIP = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_APIC = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_TPIC = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_MLS = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_XPIC = 4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_FMPM = 5_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ORDER_USL = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ORDER_MUSL = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ORDER_USF = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ORDER_USAVG = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_GRID_DYNAMIC = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_GRID_GROW_ONLY = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_GRID_STATIC = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ACCESS_READ = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ACCESS_WRITE = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALL_STICKY = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALL_SLIP = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALL_SEPARATING = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_WALL_FRICTION = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_COMPONENT_X = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_COMPONENT_Y = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_COMPONENT_Z = 4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_STEPS_BETWEEN_CHECKS = 50_c_int32_t
  integer(c_int64_t), parameter, public :: LAHAR_ALL_BODIES = -1_c_int64_t

  type, bind(c), public :: lahar_plugin_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    integer(c_int64_t) :: model_count = 0
    type(c_ptr) :: id = c_null_ptr
    type(c_ptr) :: version = c_null_ptr
    type(c_ptr) :: author = c_null_ptr
    type(c_ptr) :: licence = c_null_ptr
    type(c_ptr) :: url = c_null_ptr
    type(c_ptr) :: path = c_null_ptr
  end type lahar_plugin_info

  type, bind(c), public :: lahar_error_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: code = 0
    integer(c_int64_t) :: body = 0
    integer(c_int64_t) :: particle = 0
    integer(c_int64_t) :: step = 0
    real(c_double) :: time = 0.0_c_double
    real(c_double) :: suggested_dt = 0.0_c_double
  end type lahar_error_info

  type, bind(c), public :: lahar_model_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: kinematics = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: summary = c_null_ptr
    type(c_ptr) :: reference = c_null_ptr
    integer(c_int64_t) :: plugin = 0
    integer(c_int64_t) :: parameter_count = 0
    integer(c_int64_t) :: state_count = 0
    integer(c_int64_t) :: outputs = 0
    integer(c_int64_t) :: capabilities = 0
  end type lahar_model_info

  type, bind(c), public :: lahar_parameter_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: required = 0
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: symbol = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: description = c_null_ptr
    type(c_ptr) :: choices = c_null_ptr
    real(c_double) :: default_value = 0.0_c_double
    real(c_double) :: hard_min = 0.0_c_double
    real(c_double) :: hard_max = 0.0_c_double
    real(c_double) :: advised_min = 0.0_c_double
    real(c_double) :: advised_max = 0.0_c_double
  end type lahar_parameter_info

  type, bind(c), public :: lahar_state_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: components = 0
    integer(c_int32_t) :: rotation = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: description = c_null_ptr
    real(c_double) :: initial = 0.0_c_double
  end type lahar_state_info

  type, bind(c), public :: lahar_world_options
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: dimension = 0
    integer(c_int32_t) :: shape = 0
    integer(c_int32_t) :: transfer = 0
    integer(c_int32_t) :: order = 0
    integer(c_int32_t) :: grid_policy = 0
    real(c_double) :: spacing = 0.0_c_double
    real(c_double) :: origin(3) = 0.0_c_double
    real(c_double) :: pic_rate = 0.0_c_double
    real(c_double) :: cfl = 0.0_c_double
    real(c_double) :: gravity(3) = 0.0_c_double
    real(c_double) :: damping = 0.0_c_double
    real(c_double) :: box_min(3) = 0.0_c_double
    real(c_double) :: box_max(3) = 0.0_c_double
    integer(c_int32_t) :: wall_treatment = 0
    integer(c_int32_t) :: axisymmetric = 0
    integer(c_int32_t) :: filter_order = 0
    integer(c_int32_t) :: body_force = 0
    integer(c_int32_t) :: retries = 0
    integer(c_int32_t) :: reserved = 0
  end type lahar_world_options

  type, bind(c), public :: lahar_array
    type(c_ptr) :: data = c_null_ptr
    integer(c_int64_t) :: component_stride = 0
    integer(c_int64_t) :: point_stride = 0
  end type lahar_array

  type, bind(c), public :: lahar_particles
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    integer(c_int64_t) :: count = 0
    type(lahar_array) :: position
    type(lahar_array) :: volume
    type(lahar_array) :: mass
    type(lahar_array) :: velocity
    type(lahar_array) :: stress
    real(c_double) :: density = 0.0_c_double
    type(lahar_array) :: size
  end type lahar_particles

  type, bind(c), public :: lahar_fill
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: particles_per_cell = 0
    real(c_double) :: density = 0.0_c_double
    real(c_double) :: mass = 0.0_c_double
    real(c_double) :: velocity(3) = 0.0_c_double
    real(c_double) :: stress(6) = 0.0_c_double
  end type lahar_fill

  type, bind(c), public :: lahar_field_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: components = 0
    integer(c_int32_t) :: writable = 0
    integer(c_int32_t) :: reserved = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: description = c_null_ptr
  end type lahar_field_info

  type, bind(c), public :: lahar_view_info
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: components = 0
    type(c_ptr) :: data = c_null_ptr
    integer(c_int64_t) :: count = 0
    integer(c_int64_t) :: stride = 0
    integer(c_int64_t) :: generation = 0
  end type lahar_view_info

  type, bind(c), public :: lahar_wall
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: axis = 0
    integer(c_int32_t) :: side = 0
    integer(c_int32_t) :: kind = 0
    real(c_double) :: position = 0.0_c_double
    real(c_double) :: friction = 0.0_c_double
  end type lahar_wall

  type, bind(c), public :: lahar_table
    integer(c_int64_t) :: count = 0
    type(c_ptr) :: times = c_null_ptr
    type(c_ptr) :: values = c_null_ptr
  end type lahar_table

  type, bind(c), public :: lahar_prescribed_velocity
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: components = 0
    real(c_double) :: box_min(3) = 0.0_c_double
    real(c_double) :: box_max(3) = 0.0_c_double
    real(c_double) :: velocity(3) = 0.0_c_double
    type(lahar_table) :: table
  end type lahar_prescribed_velocity

  type, bind(c), public :: lahar_traction
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: axis = 0
    integer(c_int32_t) :: side = 0
    integer(c_int32_t) :: reserved = 0
    integer(c_int64_t) :: body = 0
    real(c_double) :: box_min(3) = 0.0_c_double
    real(c_double) :: box_max(3) = 0.0_c_double
    real(c_double) :: traction(3) = 0.0_c_double
    type(lahar_table) :: factors
  end type lahar_traction

  type, bind(c), public :: lahar_equilibrium
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    real(c_double) :: kinetic_energy = 0.0_c_double
    real(c_double) :: strain_energy = 0.0_c_double
    real(c_double) :: kinetic_ratio = 0.0_c_double
    real(c_double) :: unbalanced_force = 0.0_c_double
    real(c_double) :: external_force = 0.0_c_double
    real(c_double) :: unbalanced_ratio = 0.0_c_double
  end type lahar_equilibrium

  type, bind(c), public :: lahar_settle_criteria
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    real(c_double) :: kinetic_ratio = 0.0_c_double
    real(c_double) :: unbalanced_ratio = 0.0_c_double
    integer(c_int64_t) :: max_steps = 0
    real(c_double) :: until = 0.0_c_double
  end type lahar_settle_criteria

  type, bind(c), public :: lahar_settle_result
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: converged = 0
    integer(c_int64_t) :: steps = 0
    real(c_double) :: time = 0.0_c_double
    real(c_double) :: kinetic_ratio = 0.0_c_double
    real(c_double) :: unbalanced_ratio = 0.0_c_double
  end type lahar_settle_result

  type, bind(c), public :: lahar_grid_statistics
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: dimension = 0
    integer(c_int64_t) :: block_edge = 0
    integer(c_int64_t) :: active_blocks = 0
    integer(c_int64_t) :: active_nodes = 0
    integer(c_int64_t) :: bytes = 0
    integer(c_int64_t) :: blocks_created = 0
    integer(c_int64_t) :: blocks_removed = 0
  end type lahar_grid_statistics

  type, bind(c), public :: lahar_totals
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    integer(c_int64_t) :: particles = 0
    real(c_double) :: mass = 0.0_c_double
    real(c_double) :: momentum(3) = 0.0_c_double
    real(c_double) :: angular_momentum(3) = 0.0_c_double
    real(c_double) :: kinetic_energy = 0.0_c_double
    real(c_double) :: strain_energy = 0.0_c_double
    real(c_double) :: potential_energy = 0.0_c_double
    real(c_double) :: center_of_mass(3) = 0.0_c_double
  end type lahar_totals

  interface
    function lahar_status_name(status) &
        bind(c, name="lahar_status_name") result(answer)
      import :: c_int32_t, c_ptr
      implicit none
      integer(c_int32_t), value :: status
      type(c_ptr) :: answer
    end function lahar_status_name

    function lahar_version(major, minor, patch) &
        bind(c, name="lahar_version") result(answer)
      import :: c_int32_t
      implicit none
      integer(c_int32_t), intent(inout), optional :: major(*)
      integer(c_int32_t), intent(inout), optional :: minor(*)
      integer(c_int32_t), intent(inout), optional :: patch(*)
      integer(c_int32_t) :: answer
    end function lahar_version

    function lahar_abi_version_function() &
        bind(c, name="lahar_abi_version") result(answer)
      import :: c_int32_t
      implicit none
      integer(c_int32_t) :: answer
    end function lahar_abi_version_function

    function lahar_context_create(threads, context) &
        bind(c, name="lahar_context_create") result(answer)
      import :: c_int32_t, c_ptr
      implicit none
      integer(c_int32_t), value :: threads
      type(c_ptr), intent(out) :: context
      integer(c_int32_t) :: answer
    end function lahar_context_create

    subroutine lahar_context_free(context) &
        bind(c, name="lahar_context_free")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: context
    end subroutine lahar_context_free

    function lahar_context_thread_count(context, threads) &
        bind(c, name="lahar_context_thread_count") result(answer)
      import :: c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      integer(c_int32_t), intent(inout), optional :: threads(*)
      integer(c_int32_t) :: answer
    end function lahar_context_thread_count

    function lahar_context_simd(context) &
        bind(c, name="lahar_context_simd") result(answer)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: context
      type(c_ptr) :: answer
    end function lahar_context_simd

    function lahar_context_threads_used(context, threads) &
        bind(c, name="lahar_context_threads_used") result(answer)
      import :: c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      integer(c_int32_t), intent(inout), optional :: threads(*)
      integer(c_int32_t) :: answer
    end function lahar_context_threads_used

    function lahar_context_set_log(context, callback, user, max_level) &
        bind(c, name="lahar_context_set_log") result(answer)
      import :: c_funptr, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      type(c_funptr), value :: callback
      type(c_ptr), value :: user
      integer(c_int32_t), value :: max_level
      integer(c_int32_t) :: answer
    end function lahar_context_set_log

    subroutine lahar_log_stderr(level, message, user) &
        bind(c, name="lahar_log_stderr")
      import :: c_char, c_int32_t, c_ptr
      implicit none
      integer(c_int32_t), value :: level
      character(kind=c_char), intent(in), optional :: message(*)
      type(c_ptr), value :: user
    end subroutine lahar_log_stderr

    function lahar_context_load_plugin(context, name_or_path, plugin) &
        bind(c, name="lahar_context_load_plugin") result(answer)
      import :: c_char, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(in), optional :: name_or_path(*)
      integer(c_int64_t), intent(inout), optional :: plugin(*)
      integer(c_int32_t) :: answer
    end function lahar_context_load_plugin

    function lahar_context_register_plugin(context, plugin, index) &
        bind(c, name="lahar_context_register_plugin") result(answer)
      import :: c_funptr, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      type(c_funptr), value :: plugin
      integer(c_int64_t), intent(inout), optional :: index(*)
      integer(c_int32_t) :: answer
    end function lahar_context_register_plugin

    function lahar_context_set_capsule_folder(context, folder) &
        bind(c, name="lahar_context_set_capsule_folder") result(answer)
      import :: c_char, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(in), optional :: folder(*)
      integer(c_int32_t) :: answer
    end function lahar_context_set_capsule_folder

    function lahar_context_plugin_count(context, plugins) &
        bind(c, name="lahar_context_plugin_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), intent(inout), optional :: plugins(*)
      integer(c_int32_t) :: answer
    end function lahar_context_plugin_count

    function lahar_context_plugin_info(context, plugin, info) &
        bind(c, name="lahar_context_plugin_info") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_plugin_info
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), value :: plugin
      type(lahar_plugin_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_context_plugin_info

    function lahar_last_error_message(buffer, capacity, needed) &
        bind(c, name="lahar_last_error_message") result(answer)
      import :: c_char, c_int32_t, c_int64_t
      implicit none
      character(kind=c_char), intent(inout), optional :: buffer(*)
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: needed(*)
      integer(c_int32_t) :: answer
    end function lahar_last_error_message

    function lahar_last_error_info(info) &
        bind(c, name="lahar_last_error_info") result(answer)
      import :: c_int32_t, lahar_error_info
      implicit none
      type(lahar_error_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_last_error_info

    function lahar_context_error_message(context, buffer, capacity, needed) &
        bind(c, name="lahar_context_error_message") result(answer)
      import :: c_char, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(inout), optional :: buffer(*)
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: needed(*)
      integer(c_int32_t) :: answer
    end function lahar_context_error_message

    function lahar_context_model_count(context, models) &
        bind(c, name="lahar_context_model_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), intent(inout), optional :: models(*)
      integer(c_int32_t) :: answer
    end function lahar_context_model_count

    function lahar_context_model_info(context, model, info) &
        bind(c, name="lahar_context_model_info") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_model_info
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), value :: model
      type(lahar_model_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_context_model_info

    function lahar_context_find_model(context, name, model) &
        bind(c, name="lahar_context_find_model") result(answer)
      import :: c_char, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(in), optional :: name(*)
      integer(c_int64_t), intent(inout), optional :: model(*)
      integer(c_int32_t) :: answer
    end function lahar_context_find_model

    function lahar_context_model_parameter(context, model, parameter, info) &
        bind(c, name="lahar_context_model_parameter") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_parameter_info
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), value :: model
      integer(c_int64_t), value :: parameter
      type(lahar_parameter_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_context_model_parameter

    function lahar_context_model_state(context, model, state, info) &
        bind(c, name="lahar_context_model_state") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_state_info
      implicit none
      type(c_ptr), value :: context
      integer(c_int64_t), value :: model
      integer(c_int64_t), value :: state
      type(lahar_state_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_context_model_state

    function lahar_material_create(context, model, count, names, values, material) &
        bind(c, name="lahar_material_create") result(answer)
      import :: c_char, c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(in), optional :: model(*)
      integer(c_int64_t), value :: count
      type(c_ptr), intent(in), optional :: names(*)
      real(c_double), intent(in), optional :: values(*)
      type(c_ptr), intent(out) :: material
      integer(c_int32_t) :: answer
    end function lahar_material_create

    subroutine lahar_material_free(material) &
        bind(c, name="lahar_material_free")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: material
    end subroutine lahar_material_free

    function lahar_material_value(material, parameter, value) &
        bind(c, name="lahar_material_value") result(answer)
      import :: c_char, c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: material
      character(kind=c_char), intent(in), optional :: parameter(*)
      real(c_double), intent(inout), optional :: value(*)
      integer(c_int32_t) :: answer
    end function lahar_material_value

    function lahar_world_options_init(options, size) &
        bind(c, name="lahar_world_options_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_world_options
      implicit none
      type(lahar_world_options), intent(inout), optional :: options
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_world_options_init

    function lahar_world_create(context, options, world) &
        bind(c, name="lahar_world_create") result(answer)
      import :: c_int32_t, c_ptr, lahar_world_options
      implicit none
      type(c_ptr), value :: context
      type(lahar_world_options), intent(in), optional :: options
      type(c_ptr), intent(out) :: world
      integer(c_int32_t) :: answer
    end function lahar_world_create

    subroutine lahar_world_free(world) &
        bind(c, name="lahar_world_free")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: world
    end subroutine lahar_world_free

    function lahar_world_set_gravity(world, gravity) &
        bind(c, name="lahar_world_set_gravity") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), intent(in), optional :: gravity(3)
      integer(c_int32_t) :: answer
    end function lahar_world_set_gravity

    function lahar_world_set_damping(world, damping) &
        bind(c, name="lahar_world_set_damping") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), value :: damping
      integer(c_int32_t) :: answer
    end function lahar_world_set_damping

    function lahar_world_step(world, dt) &
        bind(c, name="lahar_world_step") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), value :: dt
      integer(c_int32_t) :: answer
    end function lahar_world_step

    function lahar_world_step_auto(world, dt) &
        bind(c, name="lahar_world_step_auto") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), intent(inout), optional :: dt(*)
      integer(c_int32_t) :: answer
    end function lahar_world_step_auto

    function lahar_world_advance(world, until, max_steps, steps_done, time) &
        bind(c, name="lahar_world_advance") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), value :: until
      integer(c_int64_t), value :: max_steps
      integer(c_int64_t), intent(inout), optional :: steps_done(*)
      real(c_double), intent(inout), optional :: time(*)
      integer(c_int32_t) :: answer
    end function lahar_world_advance

    function lahar_world_stable_dt(world, dt) &
        bind(c, name="lahar_world_stable_dt") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), intent(inout), optional :: dt(*)
      integer(c_int32_t) :: answer
    end function lahar_world_stable_dt

    function lahar_world_time(world, time) &
        bind(c, name="lahar_world_time") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), intent(inout), optional :: time(*)
      integer(c_int32_t) :: answer
    end function lahar_world_time

    function lahar_world_step_count(world, steps) &
        bind(c, name="lahar_world_step_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), intent(inout), optional :: steps(*)
      integer(c_int32_t) :: answer
    end function lahar_world_step_count

    function lahar_world_last_dt(world, dt) &
        bind(c, name="lahar_world_last_dt") result(answer)
      import :: c_double, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      real(c_double), intent(inout), optional :: dt(*)
      integer(c_int32_t) :: answer
    end function lahar_world_last_dt

    function lahar_particles_init(particles, size) &
        bind(c, name="lahar_particles_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_particles
      implicit none
      type(lahar_particles), intent(inout), optional :: particles
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_particles_init

    function lahar_fill_init(fill, size) &
        bind(c, name="lahar_fill_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_fill
      implicit none
      type(lahar_fill), intent(inout), optional :: fill
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_fill_init

    function lahar_body_add_particles(world, material, particles, body) &
        bind(c, name="lahar_body_add_particles") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_particles
      implicit none
      type(c_ptr), value :: world
      type(c_ptr), value :: material
      type(lahar_particles), intent(in), optional :: particles
      integer(c_int64_t), intent(inout), optional :: body(*)
      integer(c_int32_t) :: answer
    end function lahar_body_add_particles

    function lahar_body_add_box(world, material, min, max, fill, body) &
        bind(c, name="lahar_body_add_box") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr, lahar_fill
      implicit none
      type(c_ptr), value :: world
      type(c_ptr), value :: material
      real(c_double), intent(in), optional :: min(3)
      real(c_double), intent(in), optional :: max(3)
      type(lahar_fill), intent(in), optional :: fill
      integer(c_int64_t), intent(inout), optional :: body(*)
      integer(c_int32_t) :: answer
    end function lahar_body_add_box

    function lahar_body_add_sphere(world, material, center, radius, fill, body) &
        bind(c, name="lahar_body_add_sphere") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr, lahar_fill
      implicit none
      type(c_ptr), value :: world
      type(c_ptr), value :: material
      real(c_double), intent(in), optional :: center(3)
      real(c_double), value :: radius
      type(lahar_fill), intent(in), optional :: fill
      integer(c_int64_t), intent(inout), optional :: body(*)
      integer(c_int32_t) :: answer
    end function lahar_body_add_sphere

    function lahar_body_add_polygon(world, material, count, vertices, fill, body) &
        bind(c, name="lahar_body_add_polygon") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr, lahar_fill
      implicit none
      type(c_ptr), value :: world
      type(c_ptr), value :: material
      integer(c_int64_t), value :: count
      real(c_double), intent(in), optional :: vertices(*)
      type(lahar_fill), intent(in), optional :: fill
      integer(c_int64_t), intent(inout), optional :: body(*)
      integer(c_int32_t) :: answer
    end function lahar_body_add_polygon

    function lahar_body_remove(world, body) &
        bind(c, name="lahar_body_remove") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int32_t) :: answer
    end function lahar_body_remove

    function lahar_body_set_f_bar(world, body, on) &
        bind(c, name="lahar_body_set_f_bar") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int32_t), value :: on
      integer(c_int32_t) :: answer
    end function lahar_body_set_f_bar

    function lahar_world_body_count(world, bodies) &
        bind(c, name="lahar_world_body_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), intent(inout), optional :: bodies(*)
      integer(c_int32_t) :: answer
    end function lahar_world_body_count

    function lahar_world_bodies(world, capacity, ids, count) &
        bind(c, name="lahar_world_bodies") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: ids(*)
      integer(c_int64_t), intent(inout), optional :: count(*)
      integer(c_int32_t) :: answer
    end function lahar_world_bodies

    function lahar_body_particle_count(world, body, particles) &
        bind(c, name="lahar_body_particle_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int64_t), intent(inout), optional :: particles(*)
      integer(c_int32_t) :: answer
    end function lahar_body_particle_count

    function lahar_body_field_count(world, body, fields) &
        bind(c, name="lahar_body_field_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int64_t), intent(inout), optional :: fields(*)
      integer(c_int32_t) :: answer
    end function lahar_body_field_count

    function lahar_body_field_info(world, body, field, info) &
        bind(c, name="lahar_body_field_info") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_field_info
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int64_t), value :: field
      type(lahar_field_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_body_field_info

    function lahar_body_find_field(world, body, name, field) &
        bind(c, name="lahar_body_find_field") result(answer)
      import :: c_char, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      character(kind=c_char), intent(in), optional :: name(*)
      integer(c_int64_t), intent(inout), optional :: field(*)
      integer(c_int32_t) :: answer
    end function lahar_body_find_field

    function lahar_body_read(world, body, field, count, values, component_stride, point_stride) &
        bind(c, name="lahar_body_read") result(answer)
      import :: c_char, c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      character(kind=c_char), intent(in), optional :: field(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(inout), optional :: values(*)
      integer(c_int64_t), value :: component_stride
      integer(c_int64_t), value :: point_stride
      integer(c_int32_t) :: answer
    end function lahar_body_read

    function lahar_body_write(world, body, field, count, values, component_stride, point_stride) &
        bind(c, name="lahar_body_write") result(answer)
      import :: c_char, c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      character(kind=c_char), intent(in), optional :: field(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(in), optional :: values(*)
      integer(c_int64_t), value :: component_stride
      integer(c_int64_t), value :: point_stride
      integer(c_int32_t) :: answer
    end function lahar_body_write

    function lahar_body_ids(world, body, capacity, ids, count) &
        bind(c, name="lahar_body_ids") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: ids(*)
      integer(c_int64_t), intent(inout), optional :: count(*)
      integer(c_int32_t) :: answer
    end function lahar_body_ids

    function lahar_body_view(world, body, field, access, view) &
        bind(c, name="lahar_body_view") result(answer)
      import :: c_char, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      character(kind=c_char), intent(in), optional :: field(*)
      integer(c_int32_t), value :: access
      type(c_ptr), intent(out) :: view
      integer(c_int32_t) :: answer
    end function lahar_body_view

    function lahar_view_data(view, info) &
        bind(c, name="lahar_view_data") result(answer)
      import :: c_int32_t, c_ptr, lahar_view_info
      implicit none
      type(c_ptr), value :: view
      type(lahar_view_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_view_data

    subroutine lahar_view_free(view) &
        bind(c, name="lahar_view_free")
      import :: c_ptr
      implicit none
      type(c_ptr), value :: view
    end subroutine lahar_view_free

    function lahar_wall_init(wall, size) &
        bind(c, name="lahar_wall_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_wall
      implicit none
      type(lahar_wall), intent(inout), optional :: wall
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_wall_init

    function lahar_wall_add(world, wall, id) &
        bind(c, name="lahar_wall_add") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_wall
      implicit none
      type(c_ptr), value :: world
      type(lahar_wall), intent(in), optional :: wall
      integer(c_int64_t), intent(inout), optional :: id(*)
      integer(c_int32_t) :: answer
    end function lahar_wall_add

    function lahar_wall_remove(world, id) &
        bind(c, name="lahar_wall_remove") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      integer(c_int32_t) :: answer
    end function lahar_wall_remove

    function lahar_wall_reaction(world, id, force) &
        bind(c, name="lahar_wall_reaction") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      real(c_double), intent(inout), optional :: force(3)
      integer(c_int32_t) :: answer
    end function lahar_wall_reaction

    function lahar_prescribed_velocity_init(condition, size) &
        bind(c, name="lahar_prescribed_velocity_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_prescribed_velocity
      implicit none
      type(lahar_prescribed_velocity), intent(inout), optional :: condition
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_prescribed_velocity_init

    function lahar_prescribed_velocity_add(world, condition, id) &
        bind(c, name="lahar_prescribed_velocity_add") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_prescribed_velocity
      implicit none
      type(c_ptr), value :: world
      type(lahar_prescribed_velocity), intent(in), optional :: condition
      integer(c_int64_t), intent(inout), optional :: id(*)
      integer(c_int32_t) :: answer
    end function lahar_prescribed_velocity_add

    function lahar_prescribed_velocity_remove(world, id) &
        bind(c, name="lahar_prescribed_velocity_remove") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      integer(c_int32_t) :: answer
    end function lahar_prescribed_velocity_remove

    function lahar_prescribed_velocity_reaction(world, id, force) &
        bind(c, name="lahar_prescribed_velocity_reaction") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      real(c_double), intent(inout), optional :: force(3)
      integer(c_int32_t) :: answer
    end function lahar_prescribed_velocity_reaction

    function lahar_traction_init(traction, size) &
        bind(c, name="lahar_traction_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_traction
      implicit none
      type(lahar_traction), intent(inout), optional :: traction
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_traction_init

    function lahar_traction_add(world, traction, id) &
        bind(c, name="lahar_traction_add") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_traction
      implicit none
      type(c_ptr), value :: world
      type(lahar_traction), intent(in), optional :: traction
      integer(c_int64_t), intent(inout), optional :: id(*)
      integer(c_int32_t) :: answer
    end function lahar_traction_add

    function lahar_traction_remove(world, id) &
        bind(c, name="lahar_traction_remove") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      integer(c_int32_t) :: answer
    end function lahar_traction_remove

    function lahar_traction_force(world, id, particles, area, force) &
        bind(c, name="lahar_traction_force") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: id
      integer(c_int64_t), intent(inout), optional :: particles(*)
      real(c_double), intent(inout), optional :: area(*)
      real(c_double), intent(inout), optional :: force(3)
      integer(c_int32_t) :: answer
    end function lahar_traction_force

    function lahar_world_set_progress(world, callback, user, interval) &
        bind(c, name="lahar_world_set_progress") result(answer)
      import :: c_double, c_funptr, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      type(c_funptr), value :: callback
      type(c_ptr), value :: user
      real(c_double), value :: interval
      integer(c_int32_t) :: answer
    end function lahar_world_set_progress

    function lahar_world_set_gravity_table(world, count, times, values) &
        bind(c, name="lahar_world_set_gravity_table") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: count
      real(c_double), intent(in), optional :: times(*)
      real(c_double), intent(in), optional :: values(*)
      integer(c_int32_t) :: answer
    end function lahar_world_set_gravity_table

    function lahar_world_equilibrium(world, equilibrium) &
        bind(c, name="lahar_world_equilibrium") result(answer)
      import :: c_int32_t, c_ptr, lahar_equilibrium
      implicit none
      type(c_ptr), value :: world
      type(lahar_equilibrium), intent(inout), optional :: equilibrium
      integer(c_int32_t) :: answer
    end function lahar_world_equilibrium

    function lahar_settle_criteria_init(criteria, size) &
        bind(c, name="lahar_settle_criteria_init") result(answer)
      import :: c_int32_t, c_int64_t, lahar_settle_criteria
      implicit none
      type(lahar_settle_criteria), intent(inout), optional :: criteria
      integer(c_int64_t), value :: size
      integer(c_int32_t) :: answer
    end function lahar_settle_criteria_init

    function lahar_world_settle(world, criteria, result) &
        bind(c, name="lahar_world_settle") result(answer)
      import :: c_int32_t, c_ptr, lahar_settle_criteria, lahar_settle_result
      implicit none
      type(c_ptr), value :: world
      type(lahar_settle_criteria), intent(in), optional :: criteria
      type(lahar_settle_result), intent(inout), optional :: result
      integer(c_int32_t) :: answer
    end function lahar_world_settle

    function lahar_body_set_k0_stress(world, body, surface_level, unit_weight, k0) &
        bind(c, name="lahar_body_set_k0_stress") result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      real(c_double), value :: surface_level
      real(c_double), value :: unit_weight
      real(c_double), value :: k0
      integer(c_int32_t) :: answer
    end function lahar_body_set_k0_stress

    function lahar_body_init_state(world, body) &
        bind(c, name="lahar_body_init_state") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      integer(c_int32_t) :: answer
    end function lahar_body_init_state

    function lahar_grid_stats(world, statistics) &
        bind(c, name="lahar_grid_stats") result(answer)
      import :: c_int32_t, c_ptr, lahar_grid_statistics
      implicit none
      type(c_ptr), value :: world
      type(lahar_grid_statistics), intent(inout), optional :: statistics
      integer(c_int32_t) :: answer
    end function lahar_grid_stats

    function lahar_grid_blocks(world, capacity, coordinates, count) &
        bind(c, name="lahar_grid_blocks") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: capacity
      integer(c_int64_t), intent(inout), optional :: coordinates(*)
      integer(c_int64_t), intent(inout), optional :: count(*)
      integer(c_int32_t) :: answer
    end function lahar_grid_blocks

    function lahar_grid_find_node(world, index, node) &
        bind(c, name="lahar_grid_find_node") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), intent(in), optional :: index(3)
      integer(c_int64_t), intent(inout), optional :: node(*)
      integer(c_int32_t) :: answer
    end function lahar_grid_find_node

    function lahar_grid_node_index(world, node, index) &
        bind(c, name="lahar_grid_node_index") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: node
      integer(c_int64_t), intent(inout), optional :: index(3)
      integer(c_int32_t) :: answer
    end function lahar_grid_node_index

    function lahar_grid_field_count(world, fields) &
        bind(c, name="lahar_grid_field_count") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), intent(inout), optional :: fields(*)
      integer(c_int32_t) :: answer
    end function lahar_grid_field_count

    function lahar_grid_field_info(world, field, info) &
        bind(c, name="lahar_grid_field_info") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_field_info
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: field
      type(lahar_field_info), intent(inout), optional :: info
      integer(c_int32_t) :: answer
    end function lahar_grid_field_info

    function lahar_grid_read(world, field, count, nodes, values) &
        bind(c, name="lahar_grid_read") result(answer)
      import :: c_char, c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      character(kind=c_char), intent(in), optional :: field(*)
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in), optional :: nodes(*)
      real(c_double), intent(inout), optional :: values(*)
      integer(c_int32_t) :: answer
    end function lahar_grid_read

    function lahar_grid_sample(world, field, count, points, values, inside) &
        bind(c, name="lahar_grid_sample") result(answer)
      import :: c_char, c_double, c_int32_t, c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      character(kind=c_char), intent(in), optional :: field(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(in), optional :: points(*)
      real(c_double), intent(inout), optional :: values(*)
      integer(c_int32_t), intent(inout), optional :: inside(*)
      integer(c_int32_t) :: answer
    end function lahar_grid_sample

    function lahar_world_totals(world, body, totals) &
        bind(c, name="lahar_world_totals") result(answer)
      import :: c_int32_t, c_int64_t, c_ptr, lahar_totals
      implicit none
      type(c_ptr), value :: world
      integer(c_int64_t), value :: body
      type(lahar_totals), intent(inout), optional :: totals
      integer(c_int32_t) :: answer
    end function lahar_world_totals

    function lahar_world_write_vtp(world, path) &
        bind(c, name="lahar_world_write_vtp") result(answer)
      import :: c_char, c_int32_t, c_ptr
      implicit none
      type(c_ptr), value :: world
      character(kind=c_char), intent(in), optional :: path(*)
      integer(c_int32_t) :: answer
    end function lahar_world_write_vtp
  end interface

  public :: lahar_status_name
  public :: lahar_version
  public :: lahar_abi_version_function
  public :: lahar_context_create
  public :: lahar_context_free
  public :: lahar_context_thread_count
  public :: lahar_context_simd
  public :: lahar_context_threads_used
  public :: lahar_context_set_log
  public :: lahar_log_stderr
  public :: lahar_context_load_plugin
  public :: lahar_context_register_plugin
  public :: lahar_context_set_capsule_folder
  public :: lahar_context_plugin_count
  public :: lahar_context_plugin_info
  public :: lahar_last_error_message
  public :: lahar_last_error_info
  public :: lahar_context_error_message
  public :: lahar_context_model_count
  public :: lahar_context_model_info
  public :: lahar_context_find_model
  public :: lahar_context_model_parameter
  public :: lahar_context_model_state
  public :: lahar_material_create
  public :: lahar_material_free
  public :: lahar_material_value
  public :: lahar_world_options_init
  public :: lahar_world_create
  public :: lahar_world_free
  public :: lahar_world_set_gravity
  public :: lahar_world_set_damping
  public :: lahar_world_step
  public :: lahar_world_step_auto
  public :: lahar_world_advance
  public :: lahar_world_stable_dt
  public :: lahar_world_time
  public :: lahar_world_step_count
  public :: lahar_world_last_dt
  public :: lahar_particles_init
  public :: lahar_fill_init
  public :: lahar_body_add_particles
  public :: lahar_body_add_box
  public :: lahar_body_add_sphere
  public :: lahar_body_add_polygon
  public :: lahar_body_remove
  public :: lahar_body_set_f_bar
  public :: lahar_world_body_count
  public :: lahar_world_bodies
  public :: lahar_body_particle_count
  public :: lahar_body_field_count
  public :: lahar_body_field_info
  public :: lahar_body_find_field
  public :: lahar_body_read
  public :: lahar_body_write
  public :: lahar_body_ids
  public :: lahar_body_view
  public :: lahar_view_data
  public :: lahar_view_free
  public :: lahar_wall_init
  public :: lahar_wall_add
  public :: lahar_wall_remove
  public :: lahar_wall_reaction
  public :: lahar_prescribed_velocity_init
  public :: lahar_prescribed_velocity_add
  public :: lahar_prescribed_velocity_remove
  public :: lahar_prescribed_velocity_reaction
  public :: lahar_traction_init
  public :: lahar_traction_add
  public :: lahar_traction_remove
  public :: lahar_traction_force
  public :: lahar_world_set_progress
  public :: lahar_world_set_gravity_table
  public :: lahar_world_equilibrium
  public :: lahar_settle_criteria_init
  public :: lahar_world_settle
  public :: lahar_body_set_k0_stress
  public :: lahar_body_init_state
  public :: lahar_grid_stats
  public :: lahar_grid_blocks
  public :: lahar_grid_find_node
  public :: lahar_grid_node_index
  public :: lahar_grid_field_count
  public :: lahar_grid_field_info
  public :: lahar_grid_read
  public :: lahar_grid_sample
  public :: lahar_world_totals
  public :: lahar_world_write_vtp
  ! ---- end of the part that `cargo xtask headers` writes ----

  abstract interface
    !> The entry of a plugin, lahar_plugin_entry_v1.
    function lahar_entry_function(host) bind(c) result(plugin)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: host
      type(c_ptr) :: plugin
    end function lahar_entry_function
  end interface

  public :: lahar_entry_function

  !> Threads, log and loaded plugins.
  type, public :: lahar_context
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: create => context_create
    procedure :: free => context_free
    procedure :: thread_count => context_thread_count
    procedure :: simd => context_simd
    procedure :: threads_used => context_threads_used
    procedure :: log_to_stderr => context_log_to_stderr
    procedure :: load_plugin => context_load_plugin
    procedure :: set_capsule_folder => context_set_capsule_folder
    procedure :: register_plugin => context_register_plugin
  end type lahar_context

  !> A constitutive model with its parameters.
  type, public :: lahar_material
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: create => material_create
    procedure :: free => material_free
    procedure :: value => material_value
  end type lahar_material

  !> A grid with its bodies and walls.
  type, public :: lahar_world
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: create => world_create
    procedure :: free => world_free
    procedure :: set_gravity => world_set_gravity
    procedure :: set_gravity_table => world_set_gravity_table
    procedure :: set_damping => world_set_damping
    procedure :: step => world_step
    procedure :: advance => world_advance
    procedure :: settle => world_settle
    procedure :: set_progress => world_set_progress
    procedure :: equilibrium => world_equilibrium
    procedure :: stable_dt => world_stable_dt
    procedure :: time => world_time
    procedure :: last_dt => world_last_dt
    procedure :: step_count => world_step_count
    procedure :: totals => world_totals
    procedure :: write_vtp => world_write_vtp
    procedure :: add_particles => world_add_particles
    procedure :: add_box => world_add_box
    procedure :: add_sphere => world_add_sphere
    procedure :: add_polygon => world_add_polygon
    procedure :: remove_body => world_remove_body
    procedure :: set_f_bar => world_set_f_bar
    procedure :: body_count => world_body_count
    procedure :: particle_count => world_particle_count
    procedure :: components => world_components
    procedure, private :: read_scalars => world_read_scalars
    procedure, private :: read_vectors => world_read_vectors
    generic :: read => read_scalars, read_vectors
    procedure, private :: write_scalars => world_write_scalars
    procedure, private :: write_vectors => world_write_vectors
    generic :: write => write_scalars, write_vectors
    procedure :: ids => world_ids
    procedure :: view => world_view
    procedure :: add_wall => world_add_wall
    procedure :: remove_wall => world_remove_wall
    procedure :: wall_reaction => world_wall_reaction
    procedure :: add_prescribed_velocity => world_add_prescribed_velocity
    procedure :: remove_prescribed_velocity => world_remove_prescribed_velocity
    procedure :: prescribed_velocity_reaction => world_prescribed_velocity_reaction
    procedure :: add_traction => world_add_traction
    procedure :: remove_traction => world_remove_traction
    procedure :: traction_force => world_traction_force
    procedure :: set_k0_stress => world_set_k0_stress
    procedure :: init_state => world_init_state
    procedure :: grid_statistics => world_grid_statistics
    procedure :: find_node => world_find_node
    procedure :: sample => world_sample
  end type lahar_world

  !> The storage of a field, without a copy.
  type, public :: lahar_view
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure :: data => view_data
    procedure :: free => view_free
  end type lahar_view

  !> Called between steps, see lahar_progress_callback of lahar.h: 0 to go on, anything else cancels. A
  !> procedure of a module, since an internal one ends with its host.
  abstract interface
    function lahar_progress(steps_done, time, user) bind(c) result(answer)
      import :: c_double, c_int32_t, c_int64_t, c_ptr
      integer(c_int64_t), value :: steps_done
      real(c_double), value :: time
      type(c_ptr), value :: user
      integer(c_int32_t) :: answer
    end function lahar_progress
  end interface

  public :: lahar_progress
  public :: lahar_default_options, lahar_default_fill, lahar_default_wall, lahar_message
  public :: lahar_default_prescribed_velocity, lahar_default_traction, lahar_default_settle_criteria

contains

  ! ---- context

  !> Makes a context with its own threads; without `threads` the environment variable LAHAR_NUM_THREADS or 1.
  subroutine context_create(self, threads, stat, errmsg)
    class(lahar_context), intent(inout) :: self
    integer, intent(in), optional :: threads
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: wanted
    wanted = 0
    if (present(threads)) wanted = int(threads, c_int32_t)
    call finish(lahar_context_create(wanted, self%handle), stat, errmsg)
  end subroutine context_create

  !> Frees the context; worlds, materials and views that come from it stay usable.
  subroutine context_free(self)
    class(lahar_context), intent(inout) :: self
    call lahar_context_free(self%handle)
    self%handle = c_null_ptr
  end subroutine context_free

  !> Number of threads.
  integer function context_thread_count(self, stat, errmsg) result(threads)
    class(lahar_context), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: found(1)
    found = 0
    call finish(lahar_context_thread_count(self%handle, found), stat, errmsg)
    threads = found(1)
  end function context_thread_count

  !> Name of the instruction set of the kernels: scalar, avx2 or avx512; empty without a context. Cannot fail.
  function context_simd(self) result(name)
    class(lahar_context), intent(in) :: self
    character(:), allocatable :: name
    name = from_c(lahar_context_simd(self%handle))
  end function context_simd

  !> Number of different threads that have worked so far.
  integer function context_threads_used(self, stat, errmsg) result(threads)
    class(lahar_context), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: found(1)
    found = 0
    call finish(lahar_context_threads_used(self%handle, found), stat, errmsg)
    threads = found(1)
  end function context_threads_used

  !> Sends the log to standard error, up to one of LAHAR_LOG_...
  subroutine context_log_to_stderr(self, max_level, stat, errmsg)
    class(lahar_context), intent(in) :: self
    integer(c_int32_t), intent(in) :: max_level
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_context_set_log(self%handle, c_funloc(lahar_log_stderr), c_null_ptr, max_level), stat, errmsg)
  end subroutine context_log_to_stderr

  !> Loads a plugin by its path, or by its name from the folders of LAHAR_PLUGIN_PATH.
  subroutine context_load_plugin(self, name_or_path, stat, errmsg)
    class(lahar_context), intent(in) :: self
    character(*), intent(in) :: name_or_path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_context_load_plugin(self%handle, to_c(name_or_path)), stat, errmsg)
  end subroutine context_load_plugin

  !> Sets the folder to which a step that fails writes a capsule of its first failing point; an empty text: none are written.
  subroutine context_set_capsule_folder(self, folder, stat, errmsg)
    class(lahar_context), intent(in) :: self
    character(*), intent(in) :: folder
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_context_set_capsule_folder(self%handle, to_c(folder)), stat, errmsg)
  end subroutine context_set_capsule_folder

  !> Takes a plugin that is linked into the program by its entry, lahar_plugin_entry_v1.
  subroutine context_register_plugin(self, entry, index, stat, errmsg)
    class(lahar_context), intent(in) :: self
    procedure(lahar_entry_function) :: entry
    integer(c_int64_t), intent(out), optional :: index
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    found = -1
    call finish(lahar_context_register_plugin(self%handle, c_funloc(entry), found), stat, errmsg)
    if (present(index)) index = found(1)
  end subroutine context_register_plugin

  ! ---- material

  !> Makes a material of a loaded model from named values; parameters that are not named take their defaults.
  subroutine material_create(self, context, model, names, values, stat, errmsg)
    class(lahar_material), intent(inout) :: self
    class(lahar_context), intent(in) :: context
    character(*), intent(in) :: model
    character(*), intent(in) :: names(:)
    real(c_double), intent(in) :: values(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    character(kind=c_char), allocatable, target :: texts(:, :)
    type(c_ptr), allocatable :: pointers(:)
    integer :: i, k
    if (size(names) /= size(values)) then
      call refuse('material%create: names and values differ in length', stat, errmsg)
      return
    end if
    allocate (texts(len(names) + 1, size(names)), pointers(size(names)))
    texts = c_null_char
    do i = 1, size(names)
      do k = 1, len_trim(names(i))
        texts(k, i) = names(i)(k:k)
      end do
      pointers(i) = c_loc(texts(1, i))
    end do
    call finish(lahar_material_create(context%handle, to_c(model), size(names, kind=c_int64_t), pointers, values, &
        self%handle), stat, errmsg)
  end subroutine material_create

  !> Frees the material; bodies that are made of it keep it.
  subroutine material_free(self)
    class(lahar_material), intent(inout) :: self
    call lahar_material_free(self%handle)
    self%handle = c_null_ptr
  end subroutine material_free

  !> Value of a parameter.
  real(c_double) function material_value(self, parameter, stat, errmsg) result(value)
    class(lahar_material), intent(in) :: self
    character(*), intent(in) :: parameter
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: found(1)
    found = 0
    call finish(lahar_material_value(self%handle, to_c(parameter), found), stat, errmsg)
    value = found(1)
  end function material_value

  ! ---- world

  !> Options with their defaults; `spacing` has none and must be set.
  function lahar_default_options() result(options)
    type(lahar_world_options) :: options
    call finish(lahar_world_options_init(options, int(c_sizeof(options), c_int64_t)))
  end function lahar_default_options

  !> Makes an empty world at time 0.
  subroutine world_create(self, context, options, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    class(lahar_context), intent(in) :: context
    type(lahar_world_options), intent(in) :: options
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_world_create(context%handle, options, self%handle), stat, errmsg)
  end subroutine world_create

  !> Frees the world; open views keep its memory.
  subroutine world_free(self)
    class(lahar_world), intent(inout) :: self
    call lahar_world_free(self%handle)
    self%handle = c_null_ptr
  end subroutine world_free

  !> Sets gravity [m/s^2] from the next step on.
  subroutine world_set_gravity(self, gravity, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    real(c_double), intent(in) :: gravity(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_world_set_gravity(self%handle, gravity), stat, errmsg)
  end subroutine world_set_gravity

  !> Sets gravity values(3, row) [m/s^2] at times(row) [s], linear in between, from the next step on.
  subroutine world_set_gravity_table(self, times, values, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    real(c_double), intent(in) :: times(:), values(:, :)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (size(values, 1) /= 3 .or. size(values, 2) /= size(times)) then
      call refuse('world%set_gravity_table: values must have the shape (3, size(times))', stat, errmsg)
      return
    end if
    call finish(lahar_world_set_gravity_table(self%handle, size(times, kind=c_int64_t), times, values), stat, errmsg)
  end subroutine world_set_gravity_table

  !> Sets the local damping [-], in [0, 1), from the next step on.
  subroutine world_set_damping(self, damping, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    real(c_double), intent(in) :: damping
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_world_set_damping(self%handle, damping), stat, errmsg)
  end subroutine world_set_damping

  !> One step of length `dt` [s], or without it of the stable length, which last_dt tells.
  subroutine world_step(self, dt, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    real(c_double), intent(in), optional :: dt
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (present(dt)) then
      call finish(lahar_world_step(self%handle, dt), stat, errmsg)
    else
      call finish(lahar_world_step_auto(self%handle), stat, errmsg)
    end if
  end subroutine world_step

  !> Steps until the time `until` [s] is reached; the last step is shortened to hit it.
  subroutine world_advance(self, until, max_steps, steps_done, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    real(c_double), intent(in) :: until
    integer(c_int64_t), intent(in), optional :: max_steps
    integer(c_int64_t), intent(out), optional :: steps_done
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: most, done(1)
    integer(c_int32_t) :: status
    most = huge(most)
    if (present(max_steps)) most = max_steps
    done = 0
    status = lahar_world_advance(self%handle, until, most, done)
    if (present(steps_done)) steps_done = done(1)
    call finish(status, stat, errmsg)
  end subroutine world_advance

  !> Sets who is called between the steps of advance and settle, at most every `interval` seconds (0.1 if
  !> it is not given), with the pointer `user`; it may cancel them (LAHAR_ERROR_CANCELLED). Without
  !> arguments nobody is called any more. Callback and target must live until then, or until the world
  !> is freed.
  subroutine world_set_progress(self, callback, user, interval, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    procedure(lahar_progress), optional :: callback
    type(c_ptr), intent(in), optional :: user
    real(c_double), intent(in), optional :: interval
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(c_funptr) :: called
    type(c_ptr) :: passed
    real(c_double) :: seconds
    called = c_null_funptr
    passed = c_null_ptr
    seconds = 0.1_c_double
    if (present(callback)) called = c_funloc(callback)
    if (present(user)) passed = user
    if (present(interval)) seconds = interval
    call finish(lahar_world_set_progress(self%handle, called, passed, seconds), stat, errmsg)
  end subroutine world_set_progress

  !> Longest stable step [s]; infinity without particles.
  real(c_double) function world_stable_dt(self, stat, errmsg) result(dt)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: found(1)
    found = 0
    call finish(lahar_world_stable_dt(self%handle, found), stat, errmsg)
    dt = found(1)
  end function world_stable_dt

  !> Time [s].
  real(c_double) function world_time(self, stat, errmsg) result(time)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: found(1)
    found = 0
    call finish(lahar_world_time(self%handle, found), stat, errmsg)
    time = found(1)
  end function world_time

  !> Length of the last step [s]; 0 before the first.
  real(c_double) function world_last_dt(self, stat, errmsg) result(dt)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: found(1)
    found = 0
    call finish(lahar_world_last_dt(self%handle, found), stat, errmsg)
    dt = found(1)
  end function world_last_dt

  !> Number of steps.
  integer(c_int64_t) function world_step_count(self, stat, errmsg) result(steps)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    found = 0
    call finish(lahar_world_step_count(self%handle, found), stat, errmsg)
    steps = found(1)
  end function world_step_count

  !> Mass, momentum and energies of a body, or of all without `body`.
  function world_totals(self, body, stat, errmsg) result(totals)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in), optional :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_totals) :: totals
    integer(c_int64_t) :: which
    which = LAHAR_ALL_BODIES
    if (present(body)) which = body
    totals%struct_size = int(c_sizeof(totals), c_int32_t)
    call finish(lahar_world_totals(self%handle, which, totals), stat, errmsg)
  end function world_totals

  !> Writes all particles with their fields for ParaView.
  subroutine world_write_vtp(self, path, stat, errmsg)
    class(lahar_world), intent(in) :: self
    character(*), intent(in) :: path
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_world_write_vtp(self%handle, to_c(path)), stat, errmsg)
  end subroutine world_write_vtp

  ! ---- bodies

  !> How a shape is filled, with its defaults; one of `density` and `mass` must be set.
  function lahar_default_fill() result(fill)
    type(lahar_fill) :: fill
    call finish(lahar_fill_init(fill, int(c_sizeof(fill), c_int64_t)))
  end function lahar_default_fill

  !> Adds a body from arrays: position(dimension, n) [m], volume(n) [m^3], either mass(n) [kg] or density [kg/m^3],
  !> velocity(dimension, n) [m/s], stress(6, n) [Pa], edges(dimension, n) [m] of their domains. The particles get the ids 0 to n - 1.
  subroutine world_add_particles(self, material, position, volume, mass, density, velocity, stress, body, stat, errmsg, edges)
    class(lahar_world), intent(inout) :: self
    class(lahar_material), intent(in) :: material
    real(c_double), intent(in), contiguous, target :: position(:, :), volume(:)
    real(c_double), intent(in), contiguous, target, optional :: mass(:)
    real(c_double), intent(in), optional :: density
    real(c_double), intent(in), contiguous, target, optional :: velocity(:, :), stress(:, :), edges(:, :)
    integer(c_int64_t), intent(out), optional :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_particles) :: particles
    integer(c_int64_t) :: id(1)
    integer(c_int32_t) :: status
    integer :: n, dimension
    logical :: fits
    id = -1
    n = size(position, 2)
    fits = size(volume) == n
    if (present(mass)) fits = fits .and. size(mass) == n
    if (present(velocity)) fits = fits .and. all(shape(velocity) == shape(position))
    if (present(stress)) fits = fits .and. all(shape(stress) == [6, n])
    if (present(edges)) fits = fits .and. all(shape(edges) == shape(position))
    dimension = dimension_of(self)
    fits = fits .and. (dimension == 0 .or. dimension == size(position, 1))
    if (.not. fits) then
      call refuse('world%add_particles: the shapes of the arrays do not fit together', stat, errmsg)
      return
    end if
    call finish(lahar_particles_init(particles, int(c_sizeof(particles), c_int64_t)))
    particles%count = n
    particles%position%data = c_loc(position)
    particles%volume%data = c_loc(volume)
    if (present(mass)) particles%mass%data = c_loc(mass)
    if (present(density)) particles%density = density
    if (present(velocity)) particles%velocity%data = c_loc(velocity)
    if (present(stress)) particles%stress%data = c_loc(stress)
    if (present(edges)) particles%size%data = c_loc(edges)
    status = lahar_body_add_particles(self%handle, material%handle, particles, id)
    if (present(body)) body = id(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_particles

  !> Adds a body that fills the box between two corners [m].
  subroutine world_add_box(self, material, lower, upper, fill, body, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    class(lahar_material), intent(in) :: material
    real(c_double), intent(in) :: lower(3), upper(3)
    type(lahar_fill), intent(in) :: fill
    integer(c_int64_t), intent(out), optional :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: id(1)
    integer(c_int32_t) :: status
    id = -1
    status = lahar_body_add_box(self%handle, material%handle, lower, upper, fill, id)
    if (present(body)) body = id(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_box

  !> Adds a body that fills a sphere, or a disc in 2D; centre and radius [m].
  subroutine world_add_sphere(self, material, center, radius, fill, body, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    class(lahar_material), intent(in) :: material
    real(c_double), intent(in) :: center(3), radius
    type(lahar_fill), intent(in) :: fill
    integer(c_int64_t), intent(out), optional :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: id(1)
    integer(c_int32_t) :: status
    id = -1
    status = lahar_body_add_sphere(self%handle, material%handle, center, radius, fill, id)
    if (present(body)) body = id(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_sphere

  !> Adds a body that fills a polygon in 2D; vertices(2, n) [m].
  subroutine world_add_polygon(self, material, vertices, fill, body, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    class(lahar_material), intent(in) :: material
    real(c_double), intent(in), contiguous :: vertices(:, :)
    type(lahar_fill), intent(in) :: fill
    integer(c_int64_t), intent(out), optional :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: id(1)
    integer(c_int32_t) :: status
    if (size(vertices, 1) /= 2) then
      call refuse('world%add_polygon: expected vertices(2, n)', stat, errmsg)
      return
    end if
    id = -1
    status = lahar_body_add_polygon(self%handle, material%handle, size(vertices, 2, kind=c_int64_t), vertices, fill, id)
    if (present(body)) body = id(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_polygon

  !> Switches F-bar on or off for a body; off at first.
  subroutine world_set_f_bar(self, body, on, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    logical, intent(in) :: on
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_body_set_f_bar(self%handle, body, merge(1_c_int32_t, 0_c_int32_t, on)), stat, errmsg)
  end subroutine world_set_f_bar

  !> Removes a body.
  subroutine world_remove_body(self, body, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_body_remove(self%handle, body), stat, errmsg)
  end subroutine world_remove_body

  !> Number of bodies.
  integer(c_int64_t) function world_body_count(self, stat, errmsg) result(bodies)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    found = 0
    call finish(lahar_world_body_count(self%handle, found), stat, errmsg)
    bodies = found(1)
  end function world_body_count

  !> Number of particles of a body.
  integer(c_int64_t) function world_particle_count(self, body, stat, errmsg) result(particles)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    found = 0
    call finish(lahar_body_particle_count(self%handle, body, found), stat, errmsg)
    particles = found(1)
  end function world_particle_count

  ! ---- fields, by id

  !> Number of components of a field of a body; 0 on error.
  integer function world_components(self, body, field, stat, errmsg) result(components)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_field_info) :: info
    integer(c_int64_t) :: index(1)
    integer(c_int32_t) :: status
    info%struct_size = int(c_sizeof(info), c_int32_t)
    status = lahar_body_find_field(self%handle, body, to_c(field), index)
    if (status == LAHAR_OK) status = lahar_body_field_info(self%handle, body, index(1), info)
    components = info%components
    call finish(status, stat, errmsg)
  end function world_components

  !> Copies a field with one component, values(n), in the order of the ids.
  subroutine world_read_scalars(self, body, field, values, stat, errmsg)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    real(c_double), intent(inout), contiguous :: values(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (.not. fits(self, body, field, 1, stat, errmsg)) return
    call finish(lahar_body_read(self%handle, body, to_c(field), size(values, kind=c_int64_t), values, 1_c_int64_t, &
        1_c_int64_t), stat, errmsg)
  end subroutine world_read_scalars

  !> Copies a field, values(components, n), in the order of the ids.
  subroutine world_read_vectors(self, body, field, values, stat, errmsg)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    real(c_double), intent(inout), contiguous :: values(:, :)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (.not. fits(self, body, field, size(values, 1), stat, errmsg)) return
    call finish(lahar_body_read(self%handle, body, to_c(field), size(values, 2, kind=c_int64_t), values, 0_c_int64_t, &
        0_c_int64_t), stat, errmsg)
  end subroutine world_read_vectors

  !> Sets a field with one component, values(n), in the order of the ids.
  subroutine world_write_scalars(self, body, field, values, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    real(c_double), intent(in), contiguous :: values(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (.not. fits(self, body, field, 1, stat, errmsg)) return
    call finish(lahar_body_write(self%handle, body, to_c(field), size(values, kind=c_int64_t), values, 1_c_int64_t, &
        1_c_int64_t), stat, errmsg)
  end subroutine world_write_scalars

  !> Sets a field, values(components, n), in the order of the ids.
  subroutine world_write_vectors(self, body, field, values, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    real(c_double), intent(in), contiguous :: values(:, :)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (.not. fits(self, body, field, size(values, 1), stat, errmsg)) return
    call finish(lahar_body_write(self%handle, body, to_c(field), size(values, 2, kind=c_int64_t), values, 0_c_int64_t, &
        0_c_int64_t), stat, errmsg)
  end subroutine world_write_vectors

  ! ---- views, in storage order

  !> Ids of the particles of a body, from 0, in the order of storage; `ids` has one element per particle.
  subroutine world_ids(self, body, ids, stat, errmsg)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: body
    integer(c_int64_t), intent(inout), contiguous :: ids(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: count(1)
    call finish(lahar_body_ids(self%handle, body, size(ids, kind=c_int64_t), ids, count), stat, errmsg)
  end subroutine world_ids

  !> Opens a view of a field with LAHAR_ACCESS_READ or LAHAR_ACCESS_WRITE.
  subroutine world_view(self, body, field, access, view, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    integer(c_int32_t), intent(in) :: access
    type(lahar_view), intent(inout) :: view
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_body_view(self%handle, body, to_c(field), access, view%handle), stat, errmsg)
  end subroutine world_view

  !> Points values(particle, component) at the storage; valid until the view is freed. Null on error.
  subroutine view_data(self, values, stat, errmsg)
    class(lahar_view), intent(in) :: self
    real(c_double), pointer, intent(out) :: values(:, :)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_view_info) :: info
    real(c_double), pointer :: storage(:, :)
    integer(c_int32_t) :: status
    nullify (values)
    info%struct_size = int(c_sizeof(info), c_int32_t)
    status = lahar_view_data(self%handle, info)
    if (status == LAHAR_OK) then
      call c_f_pointer(info%data, storage, [info%stride, int(info%components, c_int64_t)])
      values => storage(:info%count, :)
    end if
    call finish(status, stat, errmsg)
  end subroutine view_data

  !> Closes the view; what `data` pointed at must not be used any more.
  subroutine view_free(self)
    class(lahar_view), intent(inout) :: self
    call lahar_view_free(self%handle)
    self%handle = c_null_ptr
  end subroutine view_free

  ! ---- walls

  !> A wall with its defaults.
  function lahar_default_wall() result(wall)
    type(lahar_wall) :: wall
    call finish(lahar_wall_init(wall, int(c_sizeof(wall), c_int64_t)))
  end function lahar_default_wall

  !> Adds a wall.
  subroutine world_add_wall(self, wall, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    type(lahar_wall), intent(in) :: wall
    integer(c_int64_t), intent(out), optional :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    integer(c_int32_t) :: status
    found = -1
    status = lahar_wall_add(self%handle, wall, found)
    if (present(id)) id = found(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_wall

  !> Removes a wall.
  subroutine world_remove_wall(self, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_wall_remove(self%handle, id), stat, errmsg)
  end subroutine world_remove_wall

  !> Force of the wall on the material in the last step [N].
  function world_wall_reaction(self, id, stat, errmsg) result(force)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: force(3)
    force = 0
    call finish(lahar_wall_reaction(self%handle, id, force), stat, errmsg)
  end function world_wall_reaction

  ! ---- prescribed velocities

  !> A prescribed velocity with its defaults; components and the box have none and must be set.
  function lahar_default_prescribed_velocity() result(condition)
    type(lahar_prescribed_velocity) :: condition
    call finish(lahar_prescribed_velocity_init(condition, int(c_sizeof(condition), c_int64_t)))
  end function lahar_default_prescribed_velocity

  !> Adds a prescribed velocity; with a table, velocities(3, row) [m/s] at times(row) [s] instead of a constant one.
  subroutine world_add_prescribed_velocity(self, condition, times, velocities, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    type(lahar_prescribed_velocity), intent(in) :: condition
    real(c_double), intent(in), optional :: times(:), velocities(:, :)
    integer(c_int64_t), intent(out), optional :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_prescribed_velocity) :: filled
    real(c_double), allocatable, target :: t(:), v(:, :)
    integer(c_int64_t) :: found(1)
    integer(c_int32_t) :: status
    found = -1
    if (present(id)) id = -1
    filled = condition
    if (present(times) .neqv. present(velocities)) then
      call refuse('world%add_prescribed_velocity: times and velocities go together', stat, errmsg)
      return
    end if
    if (present(times) .and. present(velocities)) then
      if (size(velocities, 1) /= 3 .or. size(velocities, 2) /= size(times)) then
        call refuse('world%add_prescribed_velocity: velocities must have the shape (3, size(times))', stat, errmsg)
        return
      end if
      allocate (t, source=times)
      allocate (v, source=velocities)
      filled%table%count = size(t, kind=c_int64_t)
      filled%table%times = c_loc(t)
      filled%table%values = c_loc(v)
    end if
    status = lahar_prescribed_velocity_add(self%handle, filled, found)
    if (present(id)) id = found(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_prescribed_velocity

  !> Removes a prescribed velocity.
  subroutine world_remove_prescribed_velocity(self, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_prescribed_velocity_remove(self%handle, id), stat, errmsg)
  end subroutine world_remove_prescribed_velocity

  !> Force of the prescribed velocity on the material in the last step [N].
  function world_prescribed_velocity_reaction(self, id, stat, errmsg) result(force)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: force(3)
    force = 0
    call finish(lahar_prescribed_velocity_reaction(self%handle, id, force), stat, errmsg)
  end function world_prescribed_velocity_reaction

  ! ---- tractions

  !> A traction with its defaults; body and box have none and must be set.
  function lahar_default_traction() result(traction)
    type(lahar_traction) :: traction
    call finish(lahar_traction_init(traction, int(c_sizeof(traction), c_int64_t)))
  end function lahar_default_traction

  !> Adds a traction; with a table it is multiplied by factors(row) [-] at times(row) [s].
  subroutine world_add_traction(self, traction, times, factors, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    type(lahar_traction), intent(in) :: traction
    real(c_double), intent(in), optional :: times(:), factors(:)
    integer(c_int64_t), intent(out), optional :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_traction) :: filled
    real(c_double), allocatable, target :: t(:), f(:)
    integer(c_int64_t) :: found(1)
    integer(c_int32_t) :: status
    found = -1
    if (present(id)) id = -1
    filled = traction
    if (present(times) .neqv. present(factors)) then
      call refuse('world%add_traction: times and factors go together', stat, errmsg)
      return
    end if
    if (present(times) .and. present(factors)) then
      if (size(factors) /= size(times)) then
        call refuse('world%add_traction: times and factors differ in length', stat, errmsg)
        return
      end if
      allocate (t, source=times)
      allocate (f, source=factors)
      filled%factors%count = size(t, kind=c_int64_t)
      filled%factors%times = c_loc(t)
      filled%factors%values = c_loc(f)
    end if
    status = lahar_traction_add(self%handle, filled, found)
    if (present(id)) id = found(1)
    call finish(status, stat, errmsg)
  end subroutine world_add_traction

  !> Removes a traction.
  subroutine world_remove_traction(self, id, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: id
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_traction_remove(self%handle, id), stat, errmsg)
  end subroutine world_remove_traction

  !> Force of the traction on its body in the last step [N]; the number of particles that carry it and their area [m^2].
  function world_traction_force(self, id, particles, area, stat, errmsg) result(force)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: id
    integer(c_int64_t), intent(out), optional :: particles
    real(c_double), intent(out), optional :: area
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: force(3), of_area(1)
    integer(c_int64_t) :: count(1)
    force = 0
    of_area = 0
    count = 0
    call finish(lahar_traction_force(self%handle, id, count, of_area, force), stat, errmsg)
    if (present(particles)) particles = count(1)
    if (present(area)) area = of_area(1)
  end function world_traction_force

  ! ---- statics

  !> Criteria with their defaults.
  function lahar_default_settle_criteria() result(criteria)
    type(lahar_settle_criteria) :: criteria
    call finish(lahar_settle_criteria_init(criteria, int(c_sizeof(criteria), c_int64_t)))
  end function lahar_default_settle_criteria

  !> How far the world is from equilibrium.
  function world_equilibrium(self, stat, errmsg) result(equilibrium)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_equilibrium) :: equilibrium
    equilibrium%struct_size = int(c_sizeof(equilibrium), c_int32_t)
    call finish(lahar_world_equilibrium(self%handle, equilibrium), stat, errmsg)
  end function world_equilibrium

  !> Steps until the world is in equilibrium, or until steps or time have run out: converged tells, which is optional like the
  !> whole result.
  subroutine world_settle(self, criteria, converged, settled, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    type(lahar_settle_criteria), intent(in), optional :: criteria
    logical, intent(out), optional :: converged
    type(lahar_settle_result), intent(out), optional :: settled
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_settle_result) :: found
    integer(c_int32_t) :: status
    found%struct_size = int(c_sizeof(found), c_int32_t)
    status = lahar_world_settle(self%handle, criteria, found)
    if (present(converged)) converged = found%converged == 1
    if (present(settled)) settled = found
    call finish(status, stat, errmsg)
  end subroutine world_settle

  !> Stress of level ground at rest in a body, with its surface at a coordinate along gravity [m]; without `unit_weight`
  !> [N/m^3] that of the body under present gravity.
  subroutine world_set_k0_stress(self, body, surface_level, k0, unit_weight, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    real(c_double), intent(in) :: surface_level, k0
    real(c_double), intent(in), optional :: unit_weight
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    real(c_double) :: weight
    weight = 0
    if (present(unit_weight)) weight = unit_weight
    call finish(lahar_body_set_k0_stress(self%handle, body, surface_level, weight, k0), stat, errmsg)
  end subroutine world_set_k0_stress

  !> Lets the model of a body derive its state from the present stresses, as when the body was added.
  subroutine world_init_state(self, body, stat, errmsg)
    class(lahar_world), intent(inout) :: self
    integer(c_int64_t), intent(in) :: body
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    call finish(lahar_body_init_state(self%handle, body), stat, errmsg)
  end subroutine world_init_state

  ! ---- grid

  !> Blocks, nodes and bytes of the grid.
  function world_grid_statistics(self, stat, errmsg) result(statistics)
    class(lahar_world), intent(in) :: self
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    type(lahar_grid_statistics) :: statistics
    statistics%struct_size = int(c_sizeof(statistics), c_int32_t)
    call finish(lahar_grid_stats(self%handle, statistics), stat, errmsg)
  end function world_grid_statistics

  !> Number of the node with an integer index; -1 if it is not active.
  integer(c_int64_t) function world_find_node(self, index, stat, errmsg) result(node)
    class(lahar_world), intent(in) :: self
    integer(c_int64_t), intent(in) :: index(3)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int64_t) :: found(1)
    found = -1
    call finish(lahar_grid_find_node(self%handle, index, found), stat, errmsg)
    node = found(1)
  end function world_find_node

  !> Values of a grid field, values(components, n), at points(dimension, n) [m]; inside(n) tells where there is material.
  subroutine world_sample(self, field, points, values, inside, stat, errmsg)
    class(lahar_world), intent(in) :: self
    character(*), intent(in) :: field
    real(c_double), intent(in), contiguous :: points(:, :)
    real(c_double), intent(inout), contiguous :: values(:, :)
    logical, intent(out), optional :: inside(:)
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer(c_int32_t) :: flags(size(points, 2))
    integer(c_int32_t) :: status
    integer :: dimension, components
    logical :: good
    dimension = dimension_of(self)
    components = grid_components(self, field, size(values, 1))
    good = size(points, 1) == dimension .and. size(points, 2) == size(values, 2) .and. size(values, 1) == components
    if (present(inside)) good = good .and. size(inside) == size(points, 2)
    if (.not. good) then
      call refuse('world%sample: expected points(dimension, n), values(components, n), inside(n)', stat, errmsg)
      return
    end if
    flags = 0
    status = lahar_grid_sample(self%handle, to_c(field), size(points, 2, kind=c_int64_t), points, values, flags)
    if (present(inside)) inside = flags /= 0
    call finish(status, stat, errmsg)
  end subroutine world_sample

  ! ---- errors and texts

  !> Text of the last error of this thread.
  function lahar_message() result(message)
    character(:), allocatable :: message
    character(kind=c_char), allocatable :: buffer(:)
    integer(c_int64_t) :: needed(1), i
    integer(c_int32_t) :: status
    needed = 1
    status = lahar_last_error_message(capacity=0_c_int64_t, needed=needed)
    allocate (buffer(needed(1)))
    buffer = c_null_char
    status = lahar_last_error_message(buffer, needed(1), needed)
    allocate (character(size(buffer) - 1) :: message)
    do i = 1, len(message, kind=c_int64_t)
      message(i:i) = buffer(i)
    end do
    if (status /= LAHAR_OK) message = 'the text of the error is not to be had'
  end function lahar_message

  !> Hands a status on, or ends the program if the caller does not take it.
  subroutine finish(status, stat, errmsg)
    integer(c_int32_t), intent(in) :: status
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (present(stat)) stat = status
    if (status == LAHAR_OK) return
    if (present(errmsg)) errmsg = lahar_message()
    if (.not. present(stat)) error stop lahar_message()
  end subroutine finish

  !> The same for a mistake that this module finds.
  subroutine refuse(text, stat, errmsg)
    character(*), intent(in) :: text
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    if (present(stat)) stat = LAHAR_ERROR_INVALID_ARGUMENT
    if (present(errmsg)) errmsg = text
    if (.not. present(stat)) error stop text
  end subroutine refuse

  !> Whether a field has the number of components that the caller's array has.
  logical function fits(world, body, field, components, stat, errmsg)
    class(lahar_world), intent(in) :: world
    integer(c_int64_t), intent(in) :: body
    character(*), intent(in) :: field
    integer, intent(in) :: components
    integer, intent(out), optional :: stat
    character(*), intent(inout), optional :: errmsg
    integer :: found
    found = world%components(body, field, stat, errmsg)
    fits = found == components
    if (found > 0 .and. .not. fits) then
      call refuse('the array has another number of components than the field '//field, stat, errmsg)
    end if
  end function fits

  !> 2 or 3; 0 on error.
  integer function dimension_of(world)
    class(lahar_world), intent(in) :: world
    type(lahar_grid_statistics) :: statistics
    integer(c_int32_t) :: status
    statistics%struct_size = int(c_sizeof(statistics), c_int32_t)
    status = lahar_grid_stats(world%handle, statistics)
    dimension_of = merge(statistics%dimension, 0, status == LAHAR_OK)
  end function dimension_of

  !> Number of components of a grid field; `otherwise` for an unknown one, which the library refuses with a better text.
  integer function grid_components(world, field, otherwise) result(components)
    class(lahar_world), intent(in) :: world
    character(*), intent(in) :: field
    integer, intent(in) :: otherwise
    type(lahar_field_info) :: info
    integer(c_int64_t) :: fields(1), i
    components = otherwise
    fields = 0
    if (lahar_grid_field_count(world%handle, fields) /= LAHAR_OK) return
    do i = 0, fields(1) - 1
      info%struct_size = int(c_sizeof(info), c_int32_t)
      if (lahar_grid_field_info(world%handle, i, info) /= LAHAR_OK) return
      if (from_c(info%name) == field) components = info%components
    end do
  end function grid_components

  !> A text of C.
  function to_c(text) result(ended)
    character(*), intent(in) :: text
    character(len_trim(text) + 1, kind=c_char) :: ended
    ended = trim(text)//c_null_char
  end function to_c

  !> A text from C.
  function from_c(pointer) result(text)
    type(c_ptr), intent(in) :: pointer
    character(:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer, parameter :: longest = 4096
    integer :: n
    text = ''
    if (.not. c_associated(pointer)) return
    call c_f_pointer(pointer, letters, [longest])
    do n = 1, longest
      if (letters(n) == c_null_char) exit
      text = text//letters(n)
    end do
  end function from_c
end module lahar
