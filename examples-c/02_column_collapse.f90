! 02_column_collapse: columns of dry sand collapse. The twin of 02_column_collapse.c, where the references stand: it takes
! the same arguments and prints the same numbers. Tests compile it with -ffpe-trap=invalid,zero,overflow, as many Fortran
! hosts are: lahar works in its own floating-point environment and gives the host's back.

module column_collapse
  use, intrinsic :: iso_fortran_env, only: error_unit
  use lahar
  implicit none
  private
  public :: settings, read_arguments, run_case, print

  integer, parameter :: max_cases = 16, frames = 5
  real(lahar_real), parameter :: gravity = 9.81_lahar_real, density = 1600.0_lahar_real
  real(lahar_real), parameter :: poissons_ratio = 0.3_lahar_real, friction_angle = 30.0_lahar_real

  type :: settings
    integer :: cases = 0, cells = 40
    real(lahar_real) :: ratio(max_cases) = 0.0_lahar_real
    integer(lahar_index) :: max_steps = huge(0_lahar_index)
    character(:), allocatable :: frames
    logical :: apic = .false., compression_cone = .false.
    real(lahar_real) :: floor_friction = -1.0_lahar_real ! < 0: the sand sticks
  end type settings

  type :: column ! one collapse; SI units
    real(lahar_real) :: a, d0, h0, h, wave_speed, end_time
    real(lahar_real) :: volume0 = 0.0_lahar_real ! of each particle
    integer(lahar_index) :: body = -1
    integer :: count = 0
    type(lahar_material) :: sand
    type(lahar_world) :: world
  end type column

contains

  subroutine read_arguments(s)
    type(settings), intent(out) :: s
    character(1024) :: text
    character(:), allocatable :: value
    integer :: i, equals
    do i = 1, command_argument_count()
      call get_command_argument(i, text)
      equals = index(text, '=')
      value = trim(text(equals + 1:))
      select case (text(:equals))
      case ('a=')
        if (s%cases == max_cases) error stop 'too many columns'
        s%cases = s%cases + 1
        read (value, *) s%ratio(s%cases)
      case ('cells=')
        read (value, *) s%cells
      case ('steps=')
        read (value, *) s%max_steps
      case ('friction=')
        read (value, *) s%floor_friction
      case ('frames=', '')
        s%frames = value
      case ('transfer=')
        s%apic = value == 'apic'
        if (.not. s%apic) error stop 'transfer=apic is the only transfer to choose'
      case ('cone=')
        s%compression_cone = value == 'compression'
        if (.not. s%compression_cone) error stop 'cone=compression is the only cone to choose'
      case default
        write (error_unit, '(a)') trim(text)//': not an argument of this program; its source tells them'
        error stop 2
      end select
    end do
    if (s%cases > 0) return
    s%cases = 3
    s%ratio(:3) = [0.5_lahar_real, 1.0_lahar_real, 2.0_lahar_real]
  end subroutine read_arguments

  !> Sand that is stiff enough: its elastic waves are ten times as fast as a fall from h0 / 2.
  subroutine make_sand(context, s, c)
    type(lahar_context), intent(in) :: context
    type(settings), intent(in) :: s
    type(column), intent(inout) :: c
    real(lahar_real) :: modulus, youngs_modulus, cone
    associate (nu => poissons_ratio)
      modulus = density * c%wave_speed * c%wave_speed
      youngs_modulus = modulus * (1.0_lahar_real + nu) * (1.0_lahar_real - 2.0_lahar_real * nu) / (1.0_lahar_real - nu)
    end associate
    cone = merge(0.0_lahar_real, 2.0_lahar_real, s%compression_cone) ! 2: plane strain
    call c%sand%create(context, 'drucker_prager', [character(14) :: 'youngs_modulus', 'poissons_ratio', 'friction_angle', &
        'cohesion', 'dilation_angle', 'cone'], [youngs_modulus, poissons_ratio, friction_angle, 0.0_lahar_real, &
        0.0_lahar_real, cone])
  end subroutine make_sand

  subroutine make_world(context, s, c)
    type(lahar_context), intent(in) :: context
    type(settings), intent(in) :: s
    type(column), intent(inout) :: c
    type(lahar_world_options) :: options
    type(lahar_wall) :: wall
    options = lahar_default_options()
    options%dimension = 2
    options%spacing = c%h
    options%gravity(2) = -gravity
    options%transfer = merge(LAHAR_TRANSFER_APIC, LAHAR_TRANSFER_PIC_FLIP, s%apic)
    options%pic_rate = 0.01_lahar_real * c%wave_speed / (0.35_lahar_real * c%h)
    call c%world%create(context, options)

    wall = lahar_default_wall()
    wall%axis = 0
    wall%kind = LAHAR_WALL_SLIP
    call c%world%add_wall(wall)
    wall%axis = 1
    wall%kind = merge(LAHAR_WALL_STICKY, LAHAR_WALL_FRICTION, s%floor_friction < 0.0_lahar_real)
    wall%friction = merge(0.0_lahar_real, s%floor_friction, s%floor_friction < 0.0_lahar_real)
    call c%world%add_wall(wall)
  end subroutine make_world

  !> 2 x 2 particles a cell, with the stress of sand at rest under its own weight.
  subroutine add_column(s, c)
    type(settings), intent(in) :: s
    type(column), intent(inout) :: c
    real(lahar_real), allocatable :: position(:, :), volume(:), stress(:, :)
    real(lahar_real) :: pitch, k0, vertical
    integer :: columns, rows, i
    columns = 2 * s%cells
    rows = int(2.0_lahar_real * s%cells * c%a + 0.5_lahar_real)
    pitch = 0.5_lahar_real * c%h
    k0 = poissons_ratio / (1.0_lahar_real - poissons_ratio)
    c%count = columns * rows
    c%volume0 = pitch * pitch
    allocate (position(2, c%count), volume(c%count), stress(6, c%count))
    volume = c%volume0
    do i = 1, c%count
      position(1, i) = (mod(i - 1, columns) + 0.5_lahar_real) * pitch
      position(2, i) = ((i - 1) / columns + 0.5_lahar_real) * pitch
      vertical = -density * gravity * (c%h0 - position(2, i))
      stress(:, i) = [k0 * vertical, vertical, k0 * vertical, 0.0_lahar_real, 0.0_lahar_real, 0.0_lahar_real]
    end do
    call c%world%add_particles(c%sand, position, volume, density=density, stress=stress, body=c%body)
  end subroutine add_column

  !> Steps until the end; steps are never longer than the first stable one.
  subroutine collapse(s, c, write_frames)
    type(settings), intent(in) :: s
    type(column), intent(inout) :: c
    logical, intent(in) :: write_frames
    real(lahar_real) :: longest, time
    integer(lahar_index) :: step
    integer :: frame
    character(32) :: name
    longest = 0.4_lahar_real * c%h / (c%wave_speed + sqrt(2.0_lahar_real * gravity * c%h0))
    time = 0.0_lahar_real
    frame = 0
    do step = 0, s%max_steps
      if (write_frames .and. time >= frame * c%end_time / frames) then
        write (name, '(a, i0)') 'frame_', frame
        call c%world%write_vtp(s%frames//'/'//trim(name)//'.vtp')
        call print(trim(name)//'_time', time)
        frame = frame + 1
      end if
      if (time >= c%end_time .or. step == s%max_steps) return
      call c%world%step(min(c%world%stable_dt(), longest))
      time = c%world%time()
    end do
  end subroutine collapse

  !> What the experiments say: (x - d0)/d0, between the two laws by interpolation.
  real(lahar_real) function run_out_of_lube(a)
    real(lahar_real), intent(in) :: a
    real(lahar_real), parameter :: low = 1.2_lahar_real * 1.8_lahar_real
    real(lahar_real), parameter :: high = 1.9_lahar_real * 2.8_lahar_real**(2.0_lahar_real / 3.0_lahar_real)
    if (a <= 1.8_lahar_real) then
      run_out_of_lube = 1.2_lahar_real * a
    else if (a >= 2.8_lahar_real) then
      run_out_of_lube = 1.9_lahar_real * a**(2.0_lahar_real / 3.0_lahar_real)
    else
      run_out_of_lube = low + (high - low) * (a - 1.8_lahar_real)
    end if
  end function run_out_of_lube

  !> Prints what has become of the column. `potential0`: potential energy at the start [J].
  subroutine measure(c, number, potential0)
    type(column), intent(in) :: c
    integer, intent(in) :: number
    real(lahar_real), intent(in) :: potential0
    real(lahar_real), allocatable :: position(:, :), x(:), volume(:)
    real(lahar_real) :: near_wall, volumes, run_out_999, run_out_99, run_out_reference, height, height_reference
    type(lahar_totals) :: totals
    integer :: i
    allocate (position(2, c%count), volume(c%count))
    call c%world%read(c%body, 'position', position)
    call c%world%read(c%body, 'volume', volume)
    x = position(1, :)
    near_wall = 0.0_lahar_real
    volumes = 0.0_lahar_real
    do i = 1, c%count
      if (x(i) < 2.0_lahar_real * c%h) near_wall = near_wall + c%volume0
      volumes = volumes + volume(i)
    end do
    call sort(x)

    totals = c%world%totals(c%body)
    run_out_999 = (quantile(x, 0.999_lahar_real) - c%d0) / c%d0
    run_out_99 = (quantile(x, 0.99_lahar_real) - c%d0) / c%d0
    run_out_reference = run_out_of_lube(c%a)
    height = near_wall / (2.0_lahar_real * c%h) / c%d0
    height_reference = c%a
    if (c%a >= 0.7_lahar_real) height_reference = c%a**(1.0_lahar_real / 3.0_lahar_real)
    call print_of(number, 'run_out_reference', run_out_reference)
    call print_of(number, 'run_out_999', run_out_999)
    call print_of(number, 'run_out_999_error', run_out_999 / run_out_reference - 1.0_lahar_real)
    call print_of(number, 'run_out_99', run_out_99)
    call print_of(number, 'run_out_99_error', run_out_99 / run_out_reference - 1.0_lahar_real)
    call print_of(number, 'height_reference', height_reference)
    call print_of(number, 'height', height)
    call print_of(number, 'height_error', height / height_reference - 1.0_lahar_real)
    call print_of(number, 'kinetic_over_start_potential', totals%kinetic_energy / potential0)
    call print_of(number, 'volume_over_start_volume', volumes / (c%count * c%volume0))
  end subroutine measure

  subroutine run_case(context, s, number)
    type(lahar_context), intent(in) :: context
    type(settings), intent(in) :: s
    integer, intent(in) :: number
    type(column) :: c
    type(lahar_totals) :: at_start
    c%a = s%ratio(number)
    c%d0 = 1.0_lahar_real
    c%h0 = c%a * c%d0
    c%h = c%d0 / s%cells
    c%wave_speed = 10.0_lahar_real * sqrt(gravity * c%h0)
    c%end_time = 5.0_lahar_real * sqrt(c%h0 / gravity)
    call make_sand(context, s, c)
    call make_world(context, s, c)
    call add_column(s, c)
    at_start = c%world%totals(c%body)
    call print_of(number, 'aspect_ratio', c%a)
    call print_of(number, 'particles', real(c%count, lahar_real))

    call collapse(s, c, allocated(s%frames) .and. number == s%cases)
    call print_of(number, 'steps', real(c%world%step_count(), lahar_real))
    call print_of(number, 'time', c%world%time())
    call measure(c, number, at_start%potential_energy)
    call c%world%free()
    call c%sand%free()
  end subroutine run_case

  !> Coordinate left of which the share `q` of the particles stands; x is sorted, all masses are equal.
  real(lahar_real) function quantile(x, q)
    real(lahar_real), intent(in) :: x(:), q
    quantile = x(ceiling(q * size(x)))
  end function quantile

  !> Sorts upwards, by heaps.
  subroutine sort(x)
    real(lahar_real), intent(inout) :: x(:)
    real(lahar_real) :: last
    integer :: i
    do i = size(x) / 2, 1, -1
      call sift(x, i)
    end do
    do i = size(x), 2, -1
      last = x(i)
      x(i) = x(1)
      x(1) = last
      call sift(x(:i - 1), 1)
    end do
  end subroutine sort

  !> Lets the element `start` sink to its place in the heap.
  subroutine sift(x, start)
    real(lahar_real), intent(inout) :: x(:)
    integer, intent(in) :: start
    real(lahar_real) :: value
    integer :: parent, child
    value = x(start)
    parent = start
    do
      child = 2 * parent
      if (child > size(x)) exit
      if (child < size(x)) then
        if (x(child + 1) > x(child)) child = child + 1
      end if
      if (value >= x(child)) exit
      x(parent) = x(child)
      parent = child
    end do
    x(parent) = value
  end subroutine sift

  subroutine print_of(number, name, value)
    integer, intent(in) :: number
    character(*), intent(in) :: name
    real(lahar_real), intent(in) :: value
    character(16) :: head
    write (head, '(a, i0, a)') 'case', number, '_'
    call print(trim(head)//name, value)
  end subroutine print_of

  !> One line `name = value` that reads back to the same number.
  subroutine print(name, value)
    character(*), intent(in) :: name
    real(lahar_real), intent(in) :: value
    write (*, '(a, " = ", es25.17e3)') name, value
  end subroutine print
end module column_collapse

program main
  use lahar
  use column_collapse
  implicit none
  type(settings) :: s
  type(lahar_context) :: context
  integer :: number
  call read_arguments(s)
  call context%create()
  call context%log_to_stderr(LAHAR_LOG_WARNING)
  call context%load_plugin('lahar_drucker_prager')
  call print('cases', real(s%cases, lahar_real))
  do number = 1, s%cases
    call run_case(context, s, number)
  end do
  call context%free()
end program main
