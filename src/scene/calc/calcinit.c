/* calcinit.c - the definitions that every function file may use
 *
 * Names and meanings are Radiance's, by its manual and its function files.
 * Names with `P. are internal.  pattern/expr.c sets the channels; those above
 * $27 are for variables that only some materials have (rad_calc_offer).
 * Source: Abramowitz & Stegun 1964, 26.2.23 (normal quantile); Catmull-Clark's
 * uniform cubic B-spline, Bernstein's and Hermite's bases. */
#include "config.h"

#include "scene/calc/calcimpl.h"

const char rad_calc_standard[] =
    "Dx=$1; Dy=$2; Dz=$3; Nx=$4; Ny=$5; Nz=$6; Px=$7; Py=$8; Pz=$9;"
    "T=$10; Rdot=$11; S=$12; Tx=$13; Ty=$14; Tz=$15;"
    "Ix=$16; Iy=$17; Iz=$18; Jx=$19; Jy=$20; Jz=$21; Kx=$22; Ky=$23; Kz=$24;"
    "Ts=$25; Lu=$26; Lv=$27;"
    "NxP=$28; NyP=$29; NzP=$30; RdotP=$31; CrP=$32; CgP=$33; CbP=$34;"
    "DxA=$35; DyA=$36; DzA=$37;"
    "D(axis)=select(axis,Dx,Dy,Dz); N(axis)=select(axis,Nx,Ny,Nz);"
    "P(axis)=select(axis,Px,Py,Pz);"
    "AC=arg(0); A1=arg(1); A2=arg(2); A3=arg(3); A4=arg(4); A5=arg(5);"
    "A6=arg(6); A7=arg(7); A8=arg(8); A9=arg(9); A10=arg(10);"
    /* constants, logic and rounding */
    "PI:3.14159265358979323846; DEGREE:PI/180; FTINY:1e-7;"
    "not(a):if(a,-1,1); and(a,b):if(a,b,a); or(a,b):if(a,a,b);"
    "xor(a,b):if(a,not(b),b);"
    "abs(v):max(v,-v); sgn(v):if(v,1,if(-v,-1,0)); sq(v):v*v; noop(v):v;"
    "inside(lo,v,hi):and(v-lo,hi-v);"
    "bound(lo,v,hi):if(lo-v,lo,if(v-hi,hi,v));"
    "clip(v):bound(0,v,1); noneg(v):max(v,0);"
    "frac(v):v-floor(v); mod(v,m):v-m*floor(v/m);"
    "tri(v,m):abs(m-mod(v-m,2*m));"
    /* functions kept within their domains */
    "Sqrt(v):if(v,sqrt(v),0); Exp(v):if(-100-v,0,exp(v));"
    "Acos(v):acos(bound(-1,v,1)); Asin(v):asin(bound(-1,v,1));"
    "Atan2(y,x):if(x*x+y*y,atan2(y,x),0);"
    /* colours */
    "red(r,g,b):noneg(r); green(r,g,b):noneg(g); blue(r,g,b):noneg(b);"
    "grey(r,g,b):noneg(.265074126*r+.670114631*g+.064811243*b);"
    "clip_r(r,g,b):clip(r); clip_g(r,g,b):clip(g); clip_b(r,g,b):clip(b);"
    "clipgrey(r,g,b):min(1,grey(r,g,b));"
    /* vectors */
    "dot(u,v):u(1)*v(1)+u(2)*v(2)+u(3)*v(3);"
    "cross(axis,u,v):select(axis,u(2)*v(3)-u(3)*v(2),u(3)*v(1)-u(1)*v(3),"
    "u(1)*v(2)-u(2)*v(1));"
    /* curves */
    "linterp(t,a,b):a*(1-t)+b*t;"
    "hermite(a,b,da,db,t):a*(1+t*t*(2*t-3))+b*t*t*(3-2*t)"
    "+da*t*(1-t)^2+db*t*t*(t-1);"
    "bezier(a,b,c,d,t):a*(1-t)^3+3*b*t*(1-t)^2+3*c*t^2*(1-t)+d*t^3;"
    "bspline(a,b,c,d,t):(a*(1-t)^3+b*(4+t*t*(3*t-6))"
    "+c*(1+3*t*(1+t*(1-t)))+d*t^3)/6;"
    "fade(near,far,dist):far+if(16-dist,(near-far)/(1+dist*dist),0);"
    /* noise */
    "noise3a(x,y,z):noise3x(x,y,z); noise3b(x,y,z):noise3y(x,y,z);"
    "noise3c(x,y,z):noise3z(x,y,z);"
    "noise3d(axis,x,y,z):select(axis,noise3x(x,y,z),noise3y(x,y,z),"
    "noise3z(x,y,z));"
    "turbulence(x,y,z,s):if(1.01-s,abs(s*noise3(x/s,y/s,z/s))"
    "+turbulence(x,y,z,2*s),0);"
    "side`P.(x,y,z,s):sgn(noise3(x/s,y/s,z/s));"
    "turbulencex(x,y,z,s):if(1.01-s,side`P.(x,y,z,s)*noise3x(x/s,y/s,z/s)"
    "+turbulencex(x,y,z,2*s),0);"
    "turbulencey(x,y,z,s):if(1.01-s,side`P.(x,y,z,s)*noise3y(x/s,y/s,z/s)"
    "+turbulencey(x,y,z,2*s),0);"
    "turbulencez(x,y,z,s):if(1.01-s,side`P.(x,y,z,s)*noise3z(x/s,y/s,z/s)"
    "+turbulencez(x,y,z,2*s),0);"
    /* from uniform to normal distribution */
    "tail`P.(t):t-(2.515517+.802853*t+.010328*t*t)"
    "/(1+1.432788*t+.189269*t*t+.001308*t*t*t);"
    "upper`P.(p):tail`P.(sqrt(-2*log(p)));"
    "unif2norm(p):if(.5-p,-upper`P.(p),upper`P.(1-p));"
    "nrand(v)=unif2norm(rand(v));"
    /* U and V: coordinates across the normal, V upright if possible */
    "flat`P.=Nx*Nx+Ny*Ny;"
    "U=if(flat`P.-FTINY,(Nx*Py-Ny*Px)/flat`P.,Px);"
    "V=if(flat`P.-FTINY,Pz-Nz*(Nx*Px+Ny*Py)/flat`P.,Py);"
    /* directions in a surface's frame: z is the normal, y the part of the up
     * vector, which the last three arguments are, across the normal */
    "up`P.(k)=arg(AC-3+k);"
    "yx`P.=up`P.(2)*NzP-up`P.(3)*NyP; yy`P.=up`P.(3)*NxP-up`P.(1)*NzP;"
    "yz`P.=up`P.(1)*NyP-up`P.(2)*NxP;"
    "ylen`P.=sqrt(yx`P.*yx`P.+yy`P.*yy`P.+yz`P.*yz`P.);"
    "Ldy(dx,dy,dz)=(dx*yx`P.+dy*yy`P.+dz*yz`P.)/ylen`P.;"
    "Ldx(dx,dy,dz)=(dx*(NyP*yz`P.-NzP*yy`P.)+dy*(NzP*yx`P.-NxP*yz`P.)"
    "+dz*(NxP*yy`P.-NyP*yx`P.))/ylen`P.;"
    "Ldz(dx,dy,dz)=dx*NxP+dy*NyP+dz*NzP;"
    "Idx=Ldx(-Dx,-Dy,-Dz); Idy=Ldy(-Dx,-Dy,-Dz); Idz=RdotP;";
