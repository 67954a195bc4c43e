!> Constitutive models for lahar in Fortran 2008, shipped as source: compile it with the model. plugins/template/own_material.f90 is
!> a model to be copied; it holds the line that compiles both.
!>
!> Two layers. The types and constants of lahar_plugin.h have the same names here. Above them, for authors:
!>
!> * lahar_new_library makes a plugin, library%add_model a model, model%add_parameter and model%add_state its tables;
!> * the author writes one routine for the constants of an instance (lahar_constants_routine) and one for a step of one point
!>   (lahar_point_routine). This module runs it over the batches, and once more without deformation where only the wave speed is wanted.
!>
!> `stop`, `error stop` and a run-time error of Fortran end the host's process, and `print` soils its output: a point that cannot be
!> updated gets the status LAHAR_POINT_FAILED instead, values that do not go together a message.
!>
!> What is made here lives as long as the process, as the contract wants.
module lahar_plugin
  use, intrinsic :: iso_c_binding
  implicit none
  private

  ! ---- begin of the part that `cargo xtask headers` writes ----
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_ABI_MAJOR = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_ABI_MINOR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_KINEMATICS_STRAIN_INCREMENT = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_KINEMATICS_VELOCITY_GRADIENT = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_KINEMATICS_DEFORMATION_GRADIENT = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_KINEMATICS_GREEN_NAGHDI = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PARAMETER_REAL = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PARAMETER_INTEGER = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PARAMETER_CHOICE = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_STATE_SCALAR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_STATE_VECTOR = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_STATE_SYMMETRIC = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_STATE_TENSOR = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ROTATION_NONE = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_ROTATION_OBJECTIVE = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_DENSITY = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_ELEMENT_LENGTH = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_TEMPERATURE = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_INTERNAL_ENERGY = 4_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_PORE_PRESSURE = 5_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_POSITION_X = 6_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_POSITION_Y = 7_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_POSITION_Z = 8_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_INPUT_PARTICLE_ID = 9_c_int32_t
  integer(c_int64_t), parameter, public :: LAHAR_OUTPUT_WAVE_SPEED = 1_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_OUTPUT_DIFFUSIVITY = 2_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_OUTPUT_ENERGY = 4_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_OUTPUT_DT_FACTOR = 8_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_OUTPUT_STATUS = 16_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_THREAD_SAFE = 1_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_POINTWISE = 2_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_DETERMINISTIC = 4_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_TANGENT = 8_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_MAY_STOP = 16_c_int64_t
  integer(c_int64_t), parameter, public :: LAHAR_CAPABILITY_MAY_PRINT = 32_c_int64_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_MEAN = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_MAX = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_TRANSFER_NEVER = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_POINT_OK = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_POINT_UNRELIABLE = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_POINT_SMALLER_STEP = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_POINT_FAILED = 3_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_OK = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_ERROR = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_LOG_ERROR = 0_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_LOG_WARNING = 1_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_LOG_INFORMATION = 2_c_int32_t
  integer(c_int32_t), parameter, public :: LAHAR_PLUGIN_LOG_DETAIL = 3_c_int32_t

  type, bind(c), public :: lahar_host_api
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: abi_minor = 0
    type(c_funptr) :: log = c_null_funptr
    type(c_funptr) :: set_error = c_null_funptr
    type(c_funptr) :: should_stop = c_null_funptr
  end type lahar_host_api

  type, bind(c), public :: lahar_parameter_desc
    type(c_ptr) :: key = c_null_ptr
    type(c_ptr) :: symbol = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: description = c_null_ptr
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: required = 0
    real(c_double) :: default_value = 0.0_c_double
    real(c_double) :: hard_min = 0.0_c_double
    real(c_double) :: hard_max = 0.0_c_double
    real(c_double) :: advised_min = 0.0_c_double
    real(c_double) :: advised_max = 0.0_c_double
    type(c_ptr) :: choices = c_null_ptr
  end type lahar_parameter_desc

  type, bind(c), public :: lahar_state_desc
    type(c_ptr) :: key = c_null_ptr
    type(c_ptr) :: unit = c_null_ptr
    type(c_ptr) :: description = c_null_ptr
    integer(c_int32_t) :: kind = 0
    integer(c_int32_t) :: rotation = 0
    real(c_double) :: initial = 0.0_c_double
  end type lahar_state_desc

  type, bind(c), public :: lahar_stress_batch
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: flags = 0
    integer(c_int64_t) :: n = 0
    integer(c_int64_t) :: stride = 0
    real(c_double) :: dt = 0.0_c_double
    real(c_double) :: time = 0.0_c_double
    integer(c_int64_t) :: step = 0
    type(c_ptr) :: strain_increment = c_null_ptr
    type(c_ptr) :: velocity_gradient = c_null_ptr
    type(c_ptr) :: deformation_gradient = c_null_ptr
    type(c_ptr) :: stress0 = c_null_ptr
    type(c_ptr) :: state0 = c_null_ptr
    type(c_ptr) :: stress1 = c_null_ptr
    type(c_ptr) :: state1 = c_null_ptr
    type(c_ptr) :: inputs = c_null_ptr
    type(c_ptr) :: wave_speed = c_null_ptr
    type(c_ptr) :: diffusivity = c_null_ptr
    type(c_ptr) :: energy = c_null_ptr
    type(c_ptr) :: dt_factor = c_null_ptr
    type(c_ptr) :: status = c_null_ptr
  end type lahar_stress_batch

  type, bind(c), public :: lahar_model_desc
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: kinematics = 0
    type(c_ptr) :: name = c_null_ptr
    type(c_ptr) :: summary = c_null_ptr
    type(c_ptr) :: reference = c_null_ptr
    integer(c_int32_t) :: parameter_count = 0
    integer(c_int32_t) :: parameter_size = 0
    type(c_ptr) :: parameters = c_null_ptr
    integer(c_int32_t) :: state_count = 0
    integer(c_int32_t) :: state_size = 0
    type(c_ptr) :: states = c_null_ptr
    integer(c_int32_t) :: input_count = 0
    integer(c_int32_t) :: required_minor = 0
    type(c_ptr) :: inputs = c_null_ptr
    integer(c_int64_t) :: outputs = 0
    integer(c_int64_t) :: capabilities = 0
    type(c_funptr) :: create = c_null_funptr
    type(c_funptr) :: destroy = c_null_funptr
    type(c_funptr) :: check = c_null_funptr
    type(c_funptr) :: init_state = c_null_funptr
    type(c_funptr) :: update = c_null_funptr
    type(c_funptr) :: wave_speed = c_null_funptr
    type(c_funptr) :: get_extension = c_null_funptr
  end type lahar_model_desc

  type, bind(c), public :: lahar_tangent_extension
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    type(c_funptr) :: tangent = c_null_funptr
  end type lahar_tangent_extension

  type, bind(c), public :: lahar_energy_extension
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: reserved = 0
    type(c_funptr) :: stored = c_null_funptr
  end type lahar_energy_extension

  type, bind(c), public :: lahar_transfer_extension
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: count = 0
    type(c_ptr) :: rules = c_null_ptr
  end type lahar_transfer_extension

  type, bind(c), public :: lahar_plugin_desc
    integer(c_int32_t) :: struct_size = 0
    integer(c_int32_t) :: abi_major = 0
    integer(c_int32_t) :: abi_minor = 0
    integer(c_int32_t) :: model_count = 0
    type(c_ptr) :: id = c_null_ptr
    type(c_ptr) :: version = c_null_ptr
    type(c_ptr) :: author = c_null_ptr
    type(c_ptr) :: licence = c_null_ptr
    type(c_ptr) :: url = c_null_ptr
    type(c_ptr) :: models = c_null_ptr
  end type lahar_plugin_desc

  ! ---- end of the part that `cargo xtask headers` writes ----

  !> A point before the step. Symmetric tensors are xx, yy, zz, xy, yz, zx, tension positive. What the kinematics do not ask for is 0.
  type, public :: lahar_point
    !> Length of the step [s]; may be 0 where only the wave speed is wanted.
    real(c_double) :: dt = 0.0_c_double
    !> Time at the start of the step [s].
    real(c_double) :: time = 0.0_c_double
    !> Number of steps before this one; -1 if there is no such count.
    integer(c_int64_t) :: step = -1
    !> dt sym L [-].
    real(c_double) :: strain_increment(6) = 0.0_c_double
    !> Velocity gradient [1/s] or deformation gradient at the end of the step [-]; gradient(i, j) is the derivative of component i
    !> along axis j.
    real(c_double) :: gradient(3, 3) = 0.0_c_double
    !> Cauchy stress at the start [Pa].
    real(c_double) :: stress(6) = 0.0_c_double
    !> Components of all state variables in their order.
    real(c_double), allocatable :: state(:)
    !> The wanted inputs in their order.
    real(c_double), allocatable :: inputs(:)
  end type lahar_point

  !> The point after the step. Stress and state arrive as they were at its start.
  type, public :: lahar_point_end
    !> Cauchy stress [Pa].
    real(c_double) :: stress(6) = 0.0_c_double
    !> Components of all state variables.
    real(c_double), allocatable :: state(:)
    !> Speed of the fastest wave [m/s]; must be set.
    real(c_double) :: wave_speed = 0.0_c_double
    !> Kinematic diffusivity [m^2/s], if declared.
    real(c_double) :: diffusivity = 0.0_c_double
    !> Energy per current volume [J/m^3], if declared.
    real(c_double) :: energy = 0.0_c_double
    !> Wanted factor on the time step [-], if declared.
    real(c_double) :: dt_factor = 1.0_c_double
    !> One of LAHAR_POINT_*.
    integer(c_int32_t) :: status = LAHAR_POINT_OK
  end type lahar_point_end

  abstract interface
    !> Makes the constants of an instance from the values of the parameters. A message refuses the values.
    subroutine lahar_constants_routine(values, constants, message)
      import :: c_double
      implicit none
      real(c_double), intent(in) :: values(:)
      real(c_double), allocatable, intent(out) :: constants(:)
      character(:), allocatable, intent(inout) :: message
    end subroutine lahar_constants_routine

    !> One step of one point.
    subroutine lahar_point_routine(constants, before, after)
      import :: c_double, lahar_point, lahar_point_end
      implicit none
      real(c_double), intent(in) :: constants(:)
      type(lahar_point), intent(in) :: before
      type(lahar_point_end), intent(inout) :: after
    end subroutine lahar_point_routine

    subroutine host_set_error(message) bind(c)
      import :: c_char
      implicit none
      character(kind=c_char), intent(in) :: message(*)
    end subroutine host_set_error

    subroutine host_log(level, message) bind(c)
      import :: c_char, c_int32_t
      implicit none
      integer(c_int32_t), value :: level
      character(kind=c_char), intent(in) :: message(*)
    end subroutine host_log
  end interface

  public :: lahar_constants_routine, lahar_point_routine

  !> A model with its tables.
  type, public :: lahar_model
    private
    type(lahar_model_desc) :: desc
    type(lahar_model), pointer :: before => null()
    type(lahar_parameter_desc), pointer :: parameters(:) => null()
    type(lahar_state_desc), pointer :: states(:) => null()
    integer(c_int32_t), pointer :: inputs(:) => null()
    integer :: state_size = 0
    procedure(lahar_constants_routine), pointer, nopass :: constants => null()
    procedure(lahar_point_routine), pointer, nopass :: point => null()
    procedure(lahar_point_routine), pointer, nopass :: first_state => null()
  contains
    procedure, public :: add_parameter
    procedure, public :: add_state
  end type lahar_model

  !> A plugin: a library of models.
  type, public :: lahar_library
    private
    type(lahar_plugin_desc) :: desc
    type(c_ptr), pointer :: models(:) => null()
    type(lahar_library), pointer :: before => null()
  contains
    procedure, public :: add_model
    procedure, public :: table
  end type lahar_library

  !> A model with one set of values.
  type :: instance_of_model
    type(lahar_model), pointer :: model => null()
    real(c_double), allocatable :: constants(:)
  end type instance_of_model

  !> One value per point.
  type :: column
    real(c_double), pointer :: values(:) => null()
  end type column

  !> The arrays of a batch; those that it does not have are not associated.
  type :: batch_arrays
    real(c_double), pointer :: strain_increment(:, :) => null(), gradient(:, :) => null()
    real(c_double), pointer :: stress0(:, :) => null(), state0(:, :) => null()
    real(c_double), pointer :: stress1(:, :) => null(), state1(:, :) => null()
    type(column), allocatable :: inputs(:)
    type(column) :: wave_speed, diffusivity, energy, dt_factor
    integer(c_int32_t), pointer :: status(:) => null()
  end type batch_arrays

  real(c_double), parameter :: infinity = transfer(9218868437227405312_c_int64_t, 1.0_c_double)
  type(lahar_host_api), pointer, save :: host => null()
  type(lahar_library), pointer, save :: last_library => null() ! keeps all of them
  type(lahar_model), pointer, save :: last_model => null() ! likewise

  public :: lahar_new_library, lahar_log

contains

  ! ---- tables

  !> A plugin without models. `host_table` is the argument of the entry.
  function lahar_new_library(host_table, id, version, author, licence, url) result(library)
    type(c_ptr), intent(in) :: host_table
    character(*), intent(in) :: id, version, author, licence
    character(*), intent(in), optional :: url
    type(lahar_library), pointer :: library
    if (c_associated(host_table)) call c_f_pointer(host_table, host)
    allocate (library)
    library%before => last_library
    last_library => library
    library%desc%struct_size = int(c_sizeof(library%desc), c_int32_t)
    library%desc%abi_major = LAHAR_PLUGIN_ABI_MAJOR
    library%desc%abi_minor = LAHAR_PLUGIN_ABI_MINOR
    library%desc%id = static_text(id)
    library%desc%version = static_text(version)
    library%desc%author = static_text(author)
    library%desc%licence = static_text(licence)
    library%desc%url = static_text('')
    if (present(url)) library%desc%url = static_text(url)
    allocate (library%models(0))
  end function lahar_new_library

  !> What the entry returns.
  function table(self)
    class(lahar_library), intent(in), target :: self
    type(c_ptr) :: table
    table = c_loc(self%desc)
  end function table

  !> Adds a model. `first_state` sets the first state, if it follows from the stress.
  function add_model(self, name, summary, reference, kinematics, inputs, outputs, capabilities, constants, point, &
      first_state) result(model)
    class(lahar_library), intent(inout) :: self
    character(*), intent(in) :: name, summary, reference
    integer(c_int32_t), intent(in) :: kinematics, inputs(:)
    integer(c_int64_t), intent(in) :: outputs, capabilities
    procedure(lahar_constants_routine) :: constants
    procedure(lahar_point_routine) :: point
    procedure(lahar_point_routine), optional :: first_state
    type(lahar_model), pointer :: model
    type(c_ptr), pointer :: longer(:)
    allocate (model)
    model%before => last_model
    last_model => model
    allocate (model%parameters(0), model%states(0))
    allocate (model%inputs(size(inputs)), source=inputs)
    model%constants => constants
    model%point => point
    if (present(first_state)) model%first_state => first_state
    model%desc%struct_size = int(c_sizeof(model%desc), c_int32_t)
    model%desc%kinematics = kinematics
    model%desc%name = static_text(name)
    model%desc%summary = static_text(summary)
    model%desc%reference = static_text(reference)
    model%desc%input_count = size(inputs, kind=c_int32_t)
    if (size(inputs) > 0) model%desc%inputs = c_loc(model%inputs(1))
    model%desc%outputs = outputs
    model%desc%capabilities = capabilities
    model%desc%create = c_funloc(create)
    model%desc%destroy = c_funloc(destroy)
    model%desc%init_state = c_funloc(init_state)
    model%desc%update = c_funloc(update)
    model%desc%wave_speed = c_funloc(wave_speed)

    allocate (longer(size(self%models) + 1))
    longer(:size(self%models)) = self%models
    longer(size(longer)) = c_loc(model%desc)
    deallocate (self%models)
    self%models => longer
    self%desc%models = c_loc(self%models(1))
    self%desc%model_count = size(self%models, kind=c_int32_t)
  end function add_model

  !> Adds a real parameter. With `default` the host need not give it; `typical` is a value of a required one with which tools try the
  !> model. Values outside the hard bounds are refused, those outside the advised ones are warned of.
  subroutine add_parameter(self, key, symbol, unit, description, default, typical, hard_min, hard_max, advised_min, advised_max)
    class(lahar_model), intent(inout) :: self
    character(*), intent(in) :: key, symbol, unit, description
    real(c_double), intent(in), optional :: default, typical, hard_min, hard_max, advised_min, advised_max
    type(lahar_parameter_desc), pointer :: longer(:)
    integer :: n
    n = size(self%parameters) + 1
    allocate (longer(n))
    longer(:n - 1) = self%parameters
    longer(n)%key = static_text(key)
    longer(n)%symbol = static_text(symbol)
    longer(n)%unit = static_text(unit)
    longer(n)%description = static_text(description)
    longer(n)%kind = LAHAR_PARAMETER_REAL
    longer(n)%required = merge(0_c_int32_t, 1_c_int32_t, present(default))
    longer(n)%default_value = or(or(0.0_c_double, typical), default)
    longer(n)%hard_min = or(-infinity, hard_min)
    longer(n)%hard_max = or(infinity, hard_max)
    longer(n)%advised_min = or(-infinity, advised_min)
    longer(n)%advised_max = or(infinity, advised_max)
    deallocate (self%parameters)
    self%parameters => longer
    self%desc%parameters = c_loc(self%parameters(1))
    self%desc%parameter_count = int(n, c_int32_t)
    self%desc%parameter_size = int(c_sizeof(self%parameters(1)), c_int32_t)
  contains
    pure real(c_double) function or(otherwise, value)
      real(c_double), intent(in) :: otherwise
      real(c_double), intent(in), optional :: value
      or = otherwise
      if (present(value)) or = value
    end function or
  end subroutine add_parameter

  !> Adds a state variable. `kind` is one of LAHAR_STATE_*, else a scalar; `rotation` one of LAHAR_ROTATION_*, else none.
  subroutine add_state(self, key, unit, description, kind, rotation, initial)
    class(lahar_model), intent(inout) :: self
    character(*), intent(in) :: key, unit, description
    integer(c_int32_t), intent(in), optional :: kind, rotation
    real(c_double), intent(in), optional :: initial
    integer, parameter :: components(0:3) = [1, 3, 6, 9]
    type(lahar_state_desc), pointer :: longer(:)
    integer :: n
    n = size(self%states) + 1
    allocate (longer(n))
    longer(:n - 1) = self%states
    longer(n)%key = static_text(key)
    longer(n)%unit = static_text(unit)
    longer(n)%description = static_text(description)
    longer(n)%kind = LAHAR_STATE_SCALAR
    if (present(kind)) longer(n)%kind = kind
    longer(n)%rotation = LAHAR_ROTATION_NONE
    if (present(rotation)) longer(n)%rotation = rotation
    if (present(initial)) longer(n)%initial = initial
    self%state_size = self%state_size + components(longer(n)%kind)
    deallocate (self%states)
    self%states => longer
    self%desc%states = c_loc(self%states(1))
    self%desc%state_count = int(n, c_int32_t)
    self%desc%state_size = int(c_sizeof(self%states(1)), c_int32_t)
  end subroutine add_state

  !> A text of C that lives as long as the process.
  function static_text(text) result(address)
    character(*), intent(in) :: text
    type(c_ptr) :: address
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    allocate (letters(len_trim(text) + 1))
    do i = 1, len_trim(text)
      letters(i) = text(i:i)
    end do
    letters(size(letters)) = c_null_char
    address = c_loc(letters(1))
  end function static_text

  ! ---- the host

  !> Hands a line to the host's log; `level` is one of LAHAR_PLUGIN_LOG_*.
  subroutine lahar_log(level, text)
    integer(c_int32_t), intent(in) :: level
    character(*), intent(in) :: text
    procedure(host_log), pointer :: log
    if (.not. associated(host)) return
    if (.not. c_associated(host%log)) return
    call c_f_procpointer(host%log, log)
    call log(level, trim(text)//c_null_char)
  end subroutine lahar_log

  subroutine tell_error(text)
    character(*), intent(in) :: text
    procedure(host_set_error), pointer :: set_error
    if (.not. associated(host)) return
    if (.not. c_associated(host%set_error)) return
    call c_f_procpointer(host%set_error, set_error)
    call set_error(trim(text)//c_null_char)
  end subroutine tell_error

  ! ---- functions of the tables

  integer(c_int32_t) function create(table, values, count, instance) bind(c, name='') result(answer)
    type(c_ptr), value :: table
    integer(c_int64_t), value :: count
    real(c_double), intent(in) :: values(count)
    type(c_ptr), intent(out) :: instance
    type(lahar_model), pointer :: model
    type(instance_of_model), pointer :: made
    character(:), allocatable :: message
    instance = c_null_ptr
    answer = LAHAR_PLUGIN_ERROR
    model => last_model
    do while (associated(model))
      if (c_associated(table, c_loc(model%desc))) exit
      model => model%before
    end do
    if (.not. associated(model)) return
    if (count /= size(model%parameters)) return
    allocate (made)
    made%model => model
    call model%constants(values, made%constants, message)
    if (allocated(message)) then
      call tell_error(message)
      deallocate (made)
      return
    end if
    instance = c_loc(made)
    answer = LAHAR_PLUGIN_OK
  end function create

  subroutine destroy(instance) bind(c, name='')
    type(c_ptr), value :: instance
    type(instance_of_model), pointer :: made
    if (.not. c_associated(instance)) return
    call c_f_pointer(instance, made)
    deallocate (made)
  end subroutine destroy

  integer(c_int32_t) function init_state(instance, batch) bind(c, name='') result(answer)
    type(c_ptr), value :: instance
    type(lahar_stress_batch), intent(in) :: batch
    type(instance_of_model), pointer :: self
    type(batch_arrays) :: b
    type(lahar_point) :: before
    type(lahar_point_end) :: after
    integer(c_int64_t) :: k
    answer = LAHAR_PLUGIN_OK
    call c_f_pointer(instance, self)
    if (.not. associated(self%model%first_state)) return
    call open_batch(self%model, batch, .false., b, before, after)
    do k = 1, batch%n
      call read_point(b, k, before, after)
      if (associated(b%state1)) after%state(:) = b%state1(k, :)
      call self%model%first_state(self%constants, before, after)
      if (associated(b%state1)) b%state1(k, :) = after%state
    end do
  end function init_state

  integer(c_int32_t) function update(instance, batch) bind(c, name='') result(answer)
    type(c_ptr), value :: instance
    type(lahar_stress_batch), intent(in) :: batch
    type(instance_of_model), pointer :: self
    type(batch_arrays) :: b
    type(lahar_point) :: before
    type(lahar_point_end) :: after
    integer(c_int64_t) :: k
    call c_f_pointer(instance, self)
    call open_batch(self%model, batch, .true., b, before, after)
    do k = 1, batch%n
      call read_point(b, k, before, after)
      call self%model%point(self%constants, before, after)
      b%stress1(k, :) = after%stress
      if (associated(b%state1)) b%state1(k, :) = after%state
      call put(b%wave_speed, k, after%wave_speed)
      call put(b%diffusivity, k, after%diffusivity)
      call put(b%energy, k, after%energy)
      call put(b%dt_factor, k, after%dt_factor)
      if (associated(b%status)) b%status(k) = after%status
    end do
    answer = LAHAR_PLUGIN_OK
  end function update

  !> The point routine without deformation: only its wave speed and diffusivity are kept.
  integer(c_int32_t) function wave_speed(instance, batch) bind(c, name='') result(answer)
    type(c_ptr), value :: instance
    type(lahar_stress_batch), intent(in) :: batch
    type(instance_of_model), pointer :: self
    type(batch_arrays) :: b
    type(lahar_point) :: before
    type(lahar_point_end) :: after
    integer(c_int64_t) :: k
    call c_f_pointer(instance, self)
    call open_batch(self%model, batch, .false., b, before, after)
    do k = 1, batch%n
      call read_point(b, k, before, after)
      call self%model%point(self%constants, before, after)
      call put(b%wave_speed, k, after%wave_speed)
      call put(b%diffusivity, k, after%diffusivity)
    end do
    answer = LAHAR_PLUGIN_OK
  end function wave_speed

  ! ---- batches

  !> Finds the arrays of a batch. What is the same for all points goes to `before`. Without `moves` there is no deformation but F.
  subroutine open_batch(model, batch, moves, b, before, after)
    class(lahar_model), intent(in) :: model
    type(lahar_stress_batch), intent(in) :: batch
    logical, intent(in) :: moves
    type(batch_arrays), intent(out) :: b
    type(lahar_point), intent(out) :: before
    type(lahar_point_end), intent(out) :: after
    type(c_ptr), pointer :: inputs(:)
    integer :: i
    b%stress0 => columns(batch%stress0, batch%stride, 6)
    b%state0 => columns(batch%state0, batch%stride, model%state_size)
    b%stress1 => columns(batch%stress1, batch%stride, 6)
    b%state1 => columns(batch%state1, batch%stride, model%state_size)
    if (moves) b%strain_increment => columns(batch%strain_increment, batch%stride, 6)
    if (moves) b%gradient => columns(batch%velocity_gradient, batch%stride, 9)
    if (model%desc%kinematics == LAHAR_KINEMATICS_DEFORMATION_GRADIENT) &
      b%gradient => columns(batch%deformation_gradient, batch%stride, 9)
    allocate (b%inputs(size(model%inputs)))
    if (size(model%inputs) > 0) call c_f_pointer(batch%inputs, inputs, [size(model%inputs)])
    do i = 1, size(model%inputs)
      b%inputs(i) = one(inputs(i), batch%n)
    end do
    b%wave_speed = one(batch%wave_speed, batch%n)
    b%diffusivity = one(batch%diffusivity, batch%n)
    b%energy = one(batch%energy, batch%n)
    b%dt_factor = one(batch%dt_factor, batch%n)
    if (c_associated(batch%status)) call c_f_pointer(batch%status, b%status, [batch%n])
    before%dt = batch%dt
    before%time = batch%time
    before%step = batch%step
    allocate (before%state(model%state_size), before%inputs(size(model%inputs)), after%state(model%state_size))
    before%state = 0.0_c_double
  end subroutine open_batch

  !> Component c of point k stands at columns(k, c).
  function columns(address, stride, components)
    type(c_ptr), intent(in) :: address
    integer(c_int64_t), intent(in) :: stride
    integer, intent(in) :: components
    real(c_double), pointer :: columns(:, :)
    nullify (columns)
    if (c_associated(address) .and. components > 0) &
      call c_f_pointer(address, columns, [stride, int(components, c_int64_t)])
  end function columns

  function one(address, n)
    type(c_ptr), intent(in) :: address
    integer(c_int64_t), intent(in) :: n
    type(column) :: one
    if (c_associated(address)) call c_f_pointer(address, one%values, [n])
  end function one

  !> Point k before the step, and the same as the start of what comes after.
  subroutine read_point(b, k, before, after)
    type(batch_arrays), intent(in) :: b
    integer(c_int64_t), intent(in) :: k
    type(lahar_point), intent(inout) :: before
    type(lahar_point_end), intent(inout) :: after
    integer :: i
    if (associated(b%strain_increment)) before%strain_increment = b%strain_increment(k, :)
    if (associated(b%gradient)) before%gradient = transpose(reshape(b%gradient(k, :), [3, 3]))
    before%stress = b%stress0(k, :)
    if (associated(b%state0)) before%state(:) = b%state0(k, :)
    do i = 1, size(b%inputs)
      before%inputs(i) = b%inputs(i)%values(k)
    end do
    after%stress = before%stress
    after%state(:) = before%state
    after%wave_speed = 0.0_c_double
    after%diffusivity = 0.0_c_double
    after%energy = 0.0_c_double
    after%dt_factor = 1.0_c_double
    after%status = LAHAR_POINT_OK
  end subroutine read_point

  subroutine put(to, k, value)
    type(column), intent(in) :: to
    integer(c_int64_t), intent(in) :: k
    real(c_double), intent(in) :: value
    if (associated(to%values)) to%values(k) = value
  end subroutine put
end module lahar_plugin
