! Writes its arguments into STATEV, in the order of the list, and gives the tangent of lambda = 3, mu = 2.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
    layer, kspt, kstep, kinc)
  implicit none
  integer, parameter :: dp = kind(1.0d0)
  character(len=*) :: cmname
  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
  real(dp) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt
  real(dp) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(2), dpred(2), props(nprops), coords(3)
  real(dp) :: drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)
  real(dp) :: seen(nstatv)
  integer :: used, i

  used = 0
  seen = -77
  call see(stress)
  call see(statev(1:1))
  call see([sum(abs(ddsdde)), sse, spd, scd, rpl, sum(abs(ddsddt)), sum(abs(drplde)), drpldt])
  call see(stran)
  call see(dstran)
  call see(time)
  call see([dtime, temp, dtemp])
  call see(predef)
  call see(dpred)
  call see([real(len(cmname), dp), real(len_trim(cmname), dp), real(iachar(cmname(1:1)), dp), real(iachar(cmname(80:80)), dp)])
  call see(real([ndi, nshr, ntens, nstatv], dp))
  call see(props)
  call see(real([nprops], dp))
  call see(coords)
  call see(reshape(drot, [9]))
  call see([pnewdt, celent])
  call see(reshape(dfgrd0, [9]))
  call see(reshape(dfgrd1, [9]))
  call see(real([noel, npt, layer, kspt, kstep, kinc], dp))
  statev = seen
  do i = 1, ntens
    stress(i) = 10 * i
    ddsdde(i, i) = merge(4, 2, i <= 3)
  end do
  ddsdde(1:3, 1:3) = ddsdde(1:3, 1:3) + 3
  sse = sse + 100
  spd = spd + 200
  scd = scd + 300

contains

  subroutine see(values)
    real(dp), intent(in) :: values(:)
    seen(used + 1:used + size(values)) = values
    used = used + size(values)
  end subroutine see
end subroutine umat

subroutine sdvini(statev, coords, nstatv, ncrds, noel, npt, layer, kspt)
  implicit none
  integer :: nstatv, ncrds, noel, npt, layer, kspt
  double precision :: statev(nstatv), coords(ncrds)
  statev(1) = 1000 * noel + 100 * npt + 10 * layer + kspt
  statev(2) = coords(1) + 10 * coords(2) + 100 * coords(ncrds)
end subroutine sdvini
