! Calls the utility routines and writes what they give into STATEV.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, kstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=80) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt
  real(dp) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops), coords(3)
  real(dp) :: drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: a(3, 3), v(3, 3), d(3, 3), p(3), turned(6), block(2, 6), eig(2, 3), vec(2, 3, 3)
  character(len=256) :: name
  integer :: i, length

  call sinv(stress, statev(1), statev(2), ndi, nshr)
  call sprinc(stress, statev(3:5), 1, ndi, nshr)
  call sprind(stran, p, v, 2, ndi, nshr)
  statev(6:8) = p
  ! The strain made of its principal values and directions is the strain.
  d = 0
  do i = 1, 3
    d = d + p(i) * spread(v(i, :), 2, 3) * spread(v(i, :), 1, 3)
  end do
  statev(9:14) = [d(1, 1), d(2, 2), d(3, 3), 2 * d(1, 2), 2 * d(1, 3), 2 * d(2, 3)] - stran
  call rotsig(stress, drot, turned, 1, ndi, nshr)
  a = reshape([stress(1), stress(4), stress(5), stress(4), stress(2), stress(6), stress(5), stress(6), stress(3)], [3, 3])
  a = matmul(drot, matmul(a, transpose(drot)))
  statev(15:20) = turned - [a(1, 1), a(2, 2), a(3, 3), a(1, 2), a(1, 3), a(2, 3)]
  call rotsig(stran, drot, turned, 2, ndi, nshr)
  statev(21) = turned(4)
  a = reshape([stran(1), stran(4) / 2, stran(5) / 2, stran(4) / 2, stran(2), stran(6) / 2, stran(5) / 2, stran(6) / 2, stran(3)], &
    [3, 3])
  a = matmul(drot, matmul(a, transpose(drot)))
  statev(22) = 2 * a(1, 2)
  call getjobname(name, length)
  statev(23) = merge(1, 0, name(1:length) == 'lahar')
  call getoutdir(name, length)
  statev(24) = merge(1, 0, name(1:1) == '/' .and. length > 1)
  block(1, :) = 0
  block(2, :) = stress([1, 2, 3, 4, 6, 5])
  call vsprind(2, block, eig, vec, 3, 3)
  a = 0
  do i = 1, 3
    a = a + eig(2, i) * spread(vec(2, :, i), 2, 3) * spread(vec(2, :, i), 1, 3)
  end do
  statev(25:30) = [a(1, 1), a(2, 2), a(3, 3), a(1, 2), a(1, 3), a(2, 3)] - stress
  call vsprinc(2, block, eig, 3, 3)
  statev(31) = sum(eig(2, :)) - sum(stress(1:3)) + sum(abs(eig(1, :)))
  do i = 1, ntens
    ddsdde(i, i) = 1
  end do
end subroutine umat
