/* A UMAT in C without the hidden length, elastic by lambda and mu, that leaves DDSDDE alone. */
void umat(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
          double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime, double *temp, double *dtemp,
          double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens, int *nstatv, double *props, int *nprops,
          double *coords, double *drot, double *pnewdt, double *celent, double *dfgrd0, double *dfgrd1, int *noel, int *npt,
          int *layer, int *kspt, int *kstep, int *kinc)
{
    double trace = dstran[0] + dstran[1] + dstran[2];
    for (int i = 0; i < *ntens; i++) {
        stress[i] += i < *ndi ? props[0] * trace + 2 * props[1] * dstran[i] : props[1] * dstran[i];
    }
}
