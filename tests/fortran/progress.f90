!> Progress in the readable layer: a callback is called between steps, asks the world, and cancels.
module watching
  use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int32_t, c_int64_t, c_ptr
  use lahar
  implicit none
  type :: watch
    integer :: calls = 0, cancel_at = 0
  end type watch
  type(lahar_world) :: world
contains
  integer(c_int32_t) function progress(steps_done, time, user) bind(c) result(answer)
    integer(c_int64_t), value :: steps_done
    real(c_double), value :: time
    type(c_ptr), value :: user
    type(watch), pointer :: w
    call c_f_pointer(user, w)
    w%calls = w%calls + 1
    if (steps_done /= w%calls) error stop 'steps'
    if (world%time() /= time) error stop 'time'
    answer = merge(1_c_int32_t, 0_c_int32_t, w%calls == w%cancel_at)
  end function progress
end module watching

program main
  use, intrinsic :: iso_c_binding, only: c_double, c_int64_t, c_loc
  use lahar
  use watching
  implicit none
  type(lahar_context) :: context
  type(lahar_material) :: material
  type(lahar_world_options) :: options
  type(lahar_fill) :: fill
  type(watch), target :: w
  integer(c_int64_t) :: body, steps
  integer :: stat
  character(400) :: message
  call context%create(1)
  call context%load_plugin('lahar_linear_elastic')
  call material%create(context, 'linear_elastic', [character(14) :: 'youngs_modulus', 'poissons_ratio'], &
      [1e6_c_double, 0.3_c_double])
  options = lahar_default_options()
  options%dimension = 2
  options%spacing = 0.1_c_double
  call world%create(context, options)
  fill = lahar_default_fill()
  fill%density = 2000
  call world%add_box(material, [0.0_c_double, 0.0_c_double, 0.0_c_double], &
      [1.0_c_double, 1.0_c_double, 0.0_c_double], fill, body)
  w%cancel_at = 4
  call world%set_progress(progress, c_loc(w), 0.0_c_double)
  call world%advance(1.0_c_double, 20_c_int64_t, steps, stat, message)
  if (stat /= LAHAR_ERROR_CANCELLED .or. index(message, 'stopped after 4 steps') == 0) error stop 'not cancelled'
  if (steps /= 4 .or. w%calls /= 4) error stop 'calls'
  call world%set_progress(progress, c_loc(w), -1.0_c_double, stat)
  if (stat /= LAHAR_ERROR_INVALID_ARGUMENT) error stop 'interval'
  call world%set_progress()
  call world%advance(1.0_c_double, 20_c_int64_t, steps)
  if (steps /= 20 .or. w%calls /= 4) error stop 'still called'
  print '(a)', 'cancelled'
  call world%free()
  call material%free()
  call context%free()
end program main
