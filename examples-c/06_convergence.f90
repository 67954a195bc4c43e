! 06_convergence: how fast errors fall as cells shrink, for three shape functions. The twin of 06_convergence.c, which tells the
! story: it takes the same arguments and prints the same numbers.

module convergence
  use lahar
  implicit none
  private
  public :: youngs_modulus, poissons_ratio, error_of, whole_argument, real_argument, print

  real(lahar_real), parameter :: pi = 3.14159265358979323846_lahar_real
  real(lahar_real), parameter :: youngs_modulus = 1e4_lahar_real, poissons_ratio = 0.3_lahar_real ! SI units; the length is 1 m
  real(lahar_real), parameter :: density = 1.0_lahar_real
  real(lahar_real), parameter :: one = 1.0_lahar_real, two = 2.0_lahar_real, half = 0.5_lahar_real

  type :: constants
    real(lahar_real) :: lambda, mu, bar_speed, wave_speed
  end type constants

contains

  function constants_of() result(k)
    type(constants) :: k
    k%lambda = youngs_modulus * poissons_ratio / ((one + poissons_ratio) * (one - two * poissons_ratio))
    k%mu = youngs_modulus / (two * (one + poissons_ratio))
    k%bar_speed = sqrt(youngs_modulus / density)
    k%wave_speed = sqrt((k%lambda + two * k%mu) / density)
  end function constants_of

  !> The force per mass for the particle that rests at X, where `swing` is A sin(pi c t).
  elemental real(lahar_real) function force_of(k, X, swing)
    type(constants), intent(in) :: k
    real(lahar_real), intent(in) :: X, swing
    real(lahar_real) :: u, f, elastic
    u = swing * sin(pi * X)
    f = one + pi * swing * cos(pi * X)
    elastic = k%lambda * (one - log(f)) / (f * f) + k%mu * (one + one / (f * f))
    force_of = pi * pi * u / density * (elastic - youngs_modulus)
  end function force_of

  !> One row of cells between four slip walls on node planes. The shape functions end there.
  subroutine make_world(context, shape, h, world)
    type(lahar_context), intent(in) :: context
    integer, intent(in) :: shape
    real(lahar_real), intent(in) :: h
    type(lahar_world), intent(inout) :: world
    type(lahar_world_options) :: options
    type(lahar_wall) :: wall
    integer :: axis
    options = lahar_default_options()
    options%dimension = 2
    options%spacing = h
    options%shape = shape
    options%transfer = LAHAR_TRANSFER_PIC_FLIP
    options%order = LAHAR_ORDER_USL
    options%wall_treatment = LAHAR_WALLS_MODIFIED
    options%body_force = 1
    options%cfl = one ! the steps are given, and shorter
    call world%create(context, options)
    wall = lahar_default_wall()
    wall%kind = LAHAR_WALL_SLIP
    do axis = 0, 1
      wall%axis = axis
      wall%side = 1
      wall%position = 0.0_lahar_real
      call world%add_wall(wall)
      wall%side = -1
      wall%position = merge(one, h, axis == 0)
      call world%add_wall(wall)
    end do
  end subroutine make_world

  !> The L2 norm of the error of the displacement over A, at t = 0.75 / c.
  real(lahar_real) function error_of(context, rubber, shape, cells, A)
    type(lahar_context), intent(in) :: context
    type(lahar_material), intent(in) :: rubber
    integer, intent(in) :: shape, cells
    real(lahar_real), intent(in) :: A
    type(lahar_world) :: world
    type(lahar_fill) :: fill
    type(constants) :: k
    real(lahar_real), allocatable :: rest(:, :), x(:, :), vector(:, :)
    real(lahar_real) :: h, end, dt, swing, low(3), high(3), away, sum
    integer(lahar_index) :: body
    integer :: n, p, step, steps
    k = constants_of()
    h = one / cells
    end = 0.75_lahar_real / k%bar_speed
    steps = ceiling(end * (k%wave_speed + pi * A * k%bar_speed) / (0.1_lahar_real * h))
    dt = end / steps
    call make_world(context, shape, h, world)
    fill = lahar_default_fill()
    fill%density = density
    fill%particles_per_cell = 2
    low = 0.0_lahar_real
    high = [one, h, 0.0_lahar_real]
    call world%add_box(rubber, low, high, fill, body)
    n = int(world%particle_count(body))
    allocate (rest(2, n), x(2, n), vector(2, n))
    call world%read(body, 'position', rest)

    ! Velocities half a step before the start make the steps those of the leapfrog scheme, of second order in time.
    vector(2, :) = 0.0_lahar_real
    do p = 1, n
      vector(1, p) = pi * k%bar_speed * A * sin(pi * rest(1, p)) * cos(half * pi * k%bar_speed * dt)
    end do
    call world%write(body, 'velocity', vector)
    do step = 0, steps - 1
      swing = A * sin(pi * k%bar_speed * (step * dt))
      vector(1, :) = force_of(k, rest(1, :), swing)
      call world%write(body, 'body_force', vector)
      call world%step(dt)
    end do

    sum = 0.0_lahar_real
    swing = A * sin(pi * k%bar_speed * end)
    call world%read(body, 'position', x)
    do p = 1, n
      away = x(1, p) - rest(1, p) - swing * sin(pi * rest(1, p))
      sum = sum + away * away
    end do
    call world%free()
    error_of = sqrt(sum / n) / A
  end function error_of

  !> A whole number from the command line.
  integer function whole_argument(position, otherwise)
    integer, intent(in) :: position, otherwise
    character(32) :: text
    whole_argument = otherwise
    if (command_argument_count() < position) return
    call get_command_argument(position, text)
    read (text, *) whole_argument
  end function whole_argument

  !> A number from the command line.
  real(lahar_real) function real_argument(position, otherwise)
    integer, intent(in) :: position
    real(lahar_real), intent(in) :: otherwise
    character(32) :: text
    real_argument = otherwise
    if (command_argument_count() < position) return
    call get_command_argument(position, text)
    read (text, *) real_argument
  end function real_argument

  !> One line `name = value` that reads back to the same number.
  subroutine print(name, value)
    character(*), intent(in) :: name
    real(lahar_real), intent(in) :: value
    write (*, '(a, " = ", es25.17e3)') name, value
  end subroutine print
end module convergence

program manufactured
  use lahar
  use convergence
  implicit none
  character(15), parameter :: names(3) = [character(15) :: 'linear', 'contiguous_gimp', 'cubic']
  integer, parameter :: shapes(3) = [LAHAR_SHAPE_LINEAR, LAHAR_SHAPE_CONTIGUOUS_GIMP, LAHAR_SHAPE_CUBIC_BSPLINE]
  type(lahar_context) :: context
  type(lahar_material) :: rubber
  character(16) :: number
  integer :: coarsest, grids, grid, cells, k
  real(lahar_real) :: A, first, error

  coarsest = whole_argument(1, 16)
  grids = whole_argument(2, 3)
  A = real_argument(3, 0.05_lahar_real)
  call context%create()
  call context%log_to_stderr(LAHAR_LOG_WARNING)
  call context%load_plugin('lahar_neo_hookean')
  call rubber%create(context, 'neo_hookean', [character(14) :: 'youngs_modulus', 'poissons_ratio'], &
      [youngs_modulus, poissons_ratio])
  do k = 1, 3
    first = 0.0_lahar_real
    error = 0.0_lahar_real
    cells = coarsest
    do grid = 1, grids
      error = error_of(context, rubber, shapes(k), cells, A)
      if (grid == 1) first = error
      write (number, '(i0)') cells
      call print(trim(names(k)) // '_error_' // trim(number), error)
      cells = 2 * cells
    end do
    call print(trim(names(k)) // '_order', log(first / error) / log(2.0_lahar_real) / (grids - 1))
  end do
  call rubber%free()
  call context%free()
end program manufactured
