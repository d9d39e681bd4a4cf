import{n as e,t}from"./index.js";function n(e,t={},...n){let r=document.createElement(e);for(let[e,n]of Object.entries(t))n!=null&&(e.startsWith(`on`)?r.addEventListener(e.slice(2),n):e!==`class`&&e in r&&!e.includes(`-`)&&e!==`list`?r[e]=n:n!==!1&&r.setAttribute(e===`class`?`class`:e,n===!0?``:String(n)));return r.append(...n.filter(e=>e!=null&&e!==!1)),r}var r={undo:`M6 3 2.5 6.5 6 10 M3 6.5h6.5a4 4 0 0 1 0 8H6`,redo:`M10 3l3.5 3.5L10 10 M13 6.5H6.5a4 4 0 0 0 0 8H10`,eye:`M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8Z M8 6.2a1.8 1.8 0 1 1 0 3.6 1.8 1.8 0 0 1 0-3.6Z`,off:`M2 2l12 12 M4 5C2.400 6.300 1.500 8 1.500 8S4 12.500 8 12.500c1 0 2-.3 2.800-.7 M6.500 3.700c.5-.1 1-.2 1.500-.2 4 0 6.500 4.500 6.500 4.500s-.6 1.100-1.700 2.200`,copy:`M5.500 5.500h8v8h-8Z M10.500 5.500v-3h-8v8h3`,bin:`M2.500 4.500h11 M6 4.500v-2h4v2 M4 4.500l.7 9h6.600l.7-9 M6.700 7v4 M9.300 7v4`,plus:`M8 3v10 M3 8h10`,split:`M8 1.500v13 M2.500 4h3v8h-3 M10.500 4h3v8h-3`,theme:`M8 2a6 6 0 1 0 0 12Z M8 2a6 6 0 0 1 0 12`,help:`M5.800 6a2.200 2.200 0 1 1 3.300 1.900c-.7.4-1.100.9-1.100 1.600v.3 M8 12.200v.3`,invert:`M2.500 2.500h11v11h-11Z M2.500 13.500l11-11 M6 13.500 13.500 6 M9.500 13.500l4-4`,frame:`M2.500 5.500v-3h3 M10.500 2.500h3v3 M13.500 10.500v3h-3 M5.500 13.500h-3v-3`,before:`M8 4.500V8l2.500 1.500 M3 5.200A5.700 5.700 0 1 1 2.400 9 M2.500 2.500v3h3`,close:`M4 4l8 8 M12 4l-8 8`,turn:`M13.500 8A5.500 5.500 0 1 1 11.500 3.700 M13.500 2v3.500H10`,brush:`M8.500 7.500 13.500 2.500 M8.500 7.500c-1.500-.8-3 0-3.500 1.500-.5 1.800-.8 3-2.500 4 2.500 1 6.500.7 7.300-2.300.3-1.300-.2-2.500-1.300-3.200Z`,hand:`M5 9V4.500a1 1 0 0 1 2 0V8 M7 7.500v-4a1 1 0 0 1 2 0v4 M9 7.500v-3a1 1 0 0 1 2 0V8 M11 7.500V6a1 1 0 0 1 2 0v4c0 2.500-1.500 4-4 4H8c-1.500 0-2.500-.7-3.300-2L3 9.300c-.7-1.200.9-2 1.600-1L5 9`,up:`M4 9.500 8 5.500l4 4`,down:`M4 6.500l4 4 4-4`,play:`M5 3.500v9l7-4.500Z`};function i(e){let t=`http://www.w3.org/2000/svg`,n=document.createElementNS(t,`svg`);n.setAttribute(`viewBox`,`0 0 16 16`),n.setAttribute(`aria-hidden`,`true`);let i=document.createElementNS(t,`path`);return i.setAttribute(`d`,r[e]),n.append(i),n}function a(e,t,r,a={}){return n(`button`,{type:`button`,class:`icon`,"aria-label":t,title:t,onclick:r,...a},i(e))}function o(e,t,r,i){let a=t.map(([e,t])=>n(`button`,{type:`button`,"aria-pressed":String(e===r),onclick:()=>i(e)},t)),o=n(`div`,{class:`segments`,role:`group`,"aria-label":e},...a);return Object.assign(o,{set(e){for(let[n,r]of a.entries())r.setAttribute(`aria-pressed`,String(t[n][0]===e))}})}function s(e,t,r,i){let a=n(`output`,{},r(t.value)),o=n(`input`,{type:`range`,min:String(t.min),max:String(t.max),step:String(t.step),"aria-label":e});o.value=String(t.value);let s=e=>{let t=o.valueAsNumber;a.textContent=r(t),o.setAttribute(`aria-valuetext`,r(t)),i(t,e)};o.addEventListener(`input`,()=>s(!1)),o.addEventListener(`change`,()=>s(!0));let c=n(`label`,{class:`slider`},n(`span`,{},e),a,o);return Object.assign(c,{set(e){o.value=String(e),a.textContent=r(e)}})}function c(e,t,r,i){let a=n(`select`,{"aria-label":e,onchange:()=>i(a.value)},...t.map(([e,t])=>n(`option`,{value:e},t)));return a.value=r,n(`label`,{class:`field`},n(`span`,{},e),a)}function l(e,t,r){let i=n(`input`,{type:`checkbox`,checked:t,onchange:()=>r(i.checked)});return n(`label`,{class:`check`},i,n(`span`,{},e))}function u(e,t){let r=URL.createObjectURL(e),i=n(`a`,{href:r,download:t});document.body.append(i),i.click(),i.remove(),setTimeout(()=>URL.revokeObjectURL(r),1e4)}function d(e,t){let r=n(`input`,{type:`file`,accept:e,hidden:!0});r.addEventListener(`change`,()=>{let e=r.files?.[0];e&&t(e),r.remove()}),document.body.append(r),r.click()}var f={choice:{},sigmas:[]},p=[],m=[],h=[],g=0;function _(){return++g}function v(e,t,n=f){let r=y(e.layers,t),{along:i,border:a,volume:o,clones:s,pose:c}=e,l=(e.fields??[]).map(e=>({...e,layers:y(e.layers,t)}));return{layers:r,along:i,border:a,volume:o,clones:s??p,pose:c??null,turned:e.turned?.length?e.turned:m,fields:l.length>0?l:h,levels:n}}function y(e,t){return e.length===0?[D(``,t)]:e.map(e=>({...e,key:_(),gains:O(e.gains,t)}))}function b(e,t){return{revision:t,layers:e.layers.map(x),along:e.along,border:e.border,volume:e.volume,clones:e.clones,pose:e.pose,turned:e.turned,fields:e.fields.map(e=>({...e,layers:e.layers.map(x)}))}}function x({key:e,...t}){return t}function S(e,t){return t===null?e.layers:e.fields.find(({field:e})=>e===t)?.layers??null}function C(e,t,n){if(t===null)return{...e,layers:n};let r=e.fields.some(({field:e})=>e===t)?e.fields.map(e=>e.field===t?{...e,layers:n}:e):[...e.fields,{field:t,layers:n}];return{...e,fields:r}}function w(e){return[...e.layers,...e.fields.flatMap(({layers:e})=>e)]}function T(e,t){let n=[...new Set([...e.fields,...t.fields].map(({field:e})=>e))].filter(n=>S(e,n)!==S(t,n)||le(e,n)!==le(t,n));return E(e,t)?n.length===1?n[0]:void 0:n.length===0?null:void 0}function E(e,t){return e.layers===t.layers&&e.along===t.along&&e.border===t.border&&e.volume===t.volume&&e.clones===t.clones&&e.pose===t.pose&&e.turned===t.turned&&e.levels===t.levels}function D(e,t,n=null){return{key:_(),name:e,on:!0,opacity:1,gains:Array(t).fill(1),region:n}}function O(e,t){return Array.from({length:t},(t,n)=>e[n]??1)}function k(e,t,n){let r=Math.min(...t,...n)/2,i=e=>{let t=e.map(e=>Math.log2(e/r));return t.map((e,n)=>[n?t[n-1]:0,e])},a=i(t);return i(n).map(([t,n])=>{let r=a.map(([r,i],a)=>({share:Math.min(n,i)-Math.max(t,r),gain:e[a]??1})).concat({share:n-Math.max(t,a.at(-1)?.[1]??0),gain:1}).filter(({share:e})=>e>1e-6),i=r[0]?.gain??1;if(r.every(({gain:e})=>e===i))return i;let o=r.reduce((e,{share:t})=>e+t,0);return r.reduce((e,{share:t,gain:n})=>e+t*n,0)/o})}function A(e,t){let n=n=>k(n,e.levels.sigmas,t.sigmas),r=e=>e.map(e=>({...e,gains:n(e.gains)})),i=e.fields.map(e=>({...e,layers:r(e.layers)}));return{...e,levels:t,layers:r(e.layers),fields:i.length>0?i:h}}function j(e,t){return t?e.map(e=>e.key===t.key?{...e,gains:e.gains.map((e,n)=>n===t.level-1?e||1:0)}:e):e}function M(e,t,n){let r=e=>e.map(e=>e.key===t?{...e,...n,key:t}:e),i=e.fields.find(({layers:e})=>e.some(e=>e.key===t));return i?C(e,i.field,r(i.layers)):{...e,layers:r(e.layers)}}function N(e,t,n,r){let i=w(e).find(e=>e.key===t);return!i||i.gains[n-1]===r?e:M(e,t,{gains:i.gains.with(n-1,r)})}function P(e){return I(e)===null&&e.turned.length===0&&ae(e)}function F(e){let{layers:t,clones:n,pose:r,turned:i}=e;if(L(t)&&n.length===0&&r===null&&i.length===0)return e;let a=t.map(e=>({...e,gains:e.gains.map(()=>1)}));return{...e,layers:a,clones:n.length>0?[]:n,pose:null,turned:m}}function I(e){let t=te(e.clones),n=e.pose&&ne(e.pose),r=n&&n.handle.length>0?n:null;return r||t.length>0?{clones:t,pose:r}:null}function ee(e){let t=new WeakMap;return n=>(t.has(n)||t.set(n,e(n)),t.get(n))}var te=ee(e=>e.filter(re).map(({name:e,on:t,...n})=>n)),ne=ee(({pinned:e,...t})=>{let n=t.handle.filter(re).map(({name:e,on:t,...n})=>n);return{...t,fixed:e===!1?null:t.fixed??null,handle:n}});function re({on:e}){return e!==!1}function ie(e,t){return e===t||e!==null&&t!==null&&e.clones===t.clones&&e.pose===t.pose}function ae(e){return L(e.layers)}function L(e){return e.every(e=>!e.on||e.opacity===0||e.gains.every(e=>e===1))}function oe(e,{kind:t,closed:n}){if(ae(e))return!1;let r=t===`cloud`,i=e.along??(r?`normal`:`free`),a=e.border??`natural`,o=!r&&!n&&(a===`keep`||a===`natural`&&e.along===null);return i!==`free`||o||e.volume===`keep`}var R=class{changed;permitted;doc;past=[];future=[];start=null;constructor(e,t,n=e=>e){this.changed=t,this.permitted=n,this.doc=e}get canUndo(){return this.past.length>0||this.start!==null}get canRedo(){return this.future.length>0}peek(e){return e===`redo`?this.future.at(-1)??null:this.start??this.past.at(-1)??null}get documents(){return{past:this.past,future:this.future}}restore(e,t){this.past=[...e],this.future=[...t]}get nSteps(){return this.past.length}commit(e){this.preview(e),this.end()}preview(e){let t=e===this.doc?e:this.permitted(e);t!==this.doc&&(this.start??=this.doc,this.doc=t,this.changed(!1))}end(){let e=this.start;this.start=null,e&&e!==this.doc&&(se(e,this.doc)?(this.doc=e,this.changed(!1)):(this.past.push(e),this.future=[],this.changed(!0)))}cancel(){this.start&&(this.doc=this.start,this.start=null,this.changed(!1))}undo(){this.end();let e=this.past.pop();return e?(this.future.push(this.doc),this.doc=e,this.changed(!0),!0):!1}redo(){let e=this.future.pop();return e?(this.past.push(this.doc),this.doc=e,this.changed(!0),!0):!1}};function se(e,t){return e.along===t.along&&e.border===t.border&&e.volume===t.volume&&e.clones===t.clones&&e.pose===t.pose&&e.turned.length===t.turned.length&&e.turned.every((e,n)=>e===t.turned[n])&&e.levels===t.levels&&de(e.layers,t.layers)&&ce(e,t)}function ce(e,t){return[...e.fields,...t.fields].every(({field:n})=>{let[r,i]=[S(e,n)??[],S(t,n)??[]],a=le(e,n)===le(t,n);return de(r,i)&&a||ue(r)&&ue(i)})}function le(e,t){return re(e.fields.find(e=>e.field===t)??{})}function ue(e){return e.length===0||e.length===1&&!e[0].name&&!e[0].region&&L(e)}function de(e,t){return e.length===t.length&&e.every((e,n)=>{let r=t[n];return e.key===r.key&&e.name===r.name&&e.on===r.on&&e.opacity===r.opacity&&e.region===r.region&&e.preset===r.preset&&e.gains.every((e,t)=>e===r.gains[t])})}var fe={mode:`pull`},pe=16,me=.4,he=8,ge={handle:[]};function _e({region:e}){return`vertices`in e&&e.vertices.indices.length===1?e.vertices.indices[0]:null}function ve(e){let{fixed:t}=e;return t?`any`in t?t.any:[t]:[]}function ye(e,t){return{...e,fixed:t.length>0?{any:[...t]}:null}}function z(e,t){let n=[];for(let r of e){if(!(`vertices`in r)){n.push(r);continue}let e=r.vertices.indices.filter(e=>!t(e));e.length===r.vertices.indices.length?n.push(r):e.length>0&&n.push({vertices:{...r.vertices,indices:e}})}return n}function be(e,t,n){return{...e,handle:e.handle.map((e,r)=>r===t?{...e,by:[...n]}:e)}}function xe(e,t){let n=0,r=-1;for(let i=0;i<e.length;i+=3){let a=(e[i]-t[0])**2+(e[i+1]-t[1])**2+(e[i+2]-t[2])**2;a>r&&(r=a,n=i/3)}return n}var Se=class{studio;pull=null;stroke=null;constructor(e){this.studio=e,e.on([`doc`,`moved`,`tool`,`shape`,`drawing`],()=>this.showHandles())}get pose(){return this.studio.doc.pose??ge}get isBusy(){return this.pull!==null||this.stroke!==null}handleAt(e,t){let{camera:n,arrays:r}=this.studio.view,i=-1,a=pe;for(let[o,s]of this.pose.handle.entries()){let c=re(s)?_e(s):null;if(c===null)continue;let l=n.project(r.place(c)),u=Math.hypot(l.x-e,l.y-t);u<a&&([i,a]=[o,u])}return i}async begin(t,n,r,i){let{studio:a}=this,{camera:o,arrays:s}=a.view,c=this.pose;if(t<0){if(!n)return!1;let{by:r}=await a.engine.call(`shift`,{vertex:n.vertex}),i={vertices:{indices:[n.vertex],radius:0}};!c.fixed&&c.handle.length===0&&(c=ye(c,[this.farPin(n)]),a.showMessage(e.pinnedFarEnd)),c={...c,handle:[...c.handle,{by:r,region:i}]},t=c.handle.length-1}let l=_e(c.handle[t]);if(l===null)return!1;let u=s.place(l),d={handle:t,start:u,by:c.handle[t].by,from:o.pointInPlane(u,r,i)};this.pull=d,a.isPulling=!0,a.view.arrays.startPull();try{let t=I({clones:a.doc.clones,pose:c})??{clones:[],pose:c},n=await a.wait(e.binding,()=>a.engine.call(`bend`,{by:t,follow:`step`,drawn:!0}));if(this.pull!==d)return!1;n===null&&(this.pull=null)}catch(e){a.showMessage(e.message,`error`),this.pull===d&&(this.pull=null)}return this.pull?(a.history.preview({...a.doc,pose:c}),!0):(a.isPulling=!1,!1)}farPin(e){let{shape:t,view:n}=this.studio;return{vertices:{indices:[xe(n.arrays.originals,e.point)],radius:he/100*t.diagonal}}}moveTo(e,t){let{pull:n,studio:r}=this;if(!n)return;let i=r.view.camera.pointInPlane(n.start,e,t),a=n.by.map((e,t)=>e+i[t]-n.from[t]);r.view.camera.setReach(Math.hypot(...a)+Math.hypot(...n.by)),r.history.preview({...r.doc,pose:be(this.pose,n.handle,a)})}end(e){let{studio:t}=this;this.isBusy&&(this.pull=null,this.stroke=null,t.isPulling=!1,e===`keep`?t.history.end():t.history.cancel(),t.display.settle())}beginStroke(e){this.studio.isPulling=e===`clone`,this.stroke={mode:e,before:this.studio.doc,vertices:[]}}touch(e){let{stroke:t,studio:n}=this;if(!t||t.vertices.includes(e))return;t.vertices.push(e);let r=U.radius/100*n.shape.diagonal;if(t.mode===`clone`){let{cloneSource:i}=n,a=t.vertices.at(-2);if(i===null||a!==void 0&&this.distance(a,e)<me*r){t.vertices.pop();return}let o={source:i,targets:[...t.vertices],radius:r,...U.strength===1?{}:{strength:U.strength}};n.history.preview({...n.doc,clones:[...t.before.clones,o]});return}let i=ve(t.before.pose??ge),a=t.mode===`pin`?[...i,{vertices:{indices:[...t.vertices],radius:r}}]:z(i,e=>t.vertices.some(t=>this.distance(e,t)<=r));n.history.preview({...n.doc,pose:ye(this.pose,a)})}distance(e,t){let n=this.studio.view.arrays.originals;return Math.hypot(n[3*e]-n[3*t],n[3*e+1]-n[3*t+1],n[3*e+2]-n[3*t+2])}showHandles(){let{studio:e,pull:t}=this,{arrays:n}=e.view,r=[],i=[];if(e.isGrabOn&&e.shape){for(let e of this.pose.pinned===!1?[]:ve(this.pose)){let t=`vertices`in e?e.vertices.indices:`ball`in e&&`vertex`in e.ball.center?[e.ball.center.vertex]:[];for(let e of t)r.push(...n.place(e)),i.push(-1)}for(let[e,a]of this.pose.handle.entries()){let o=re(a)?_e(a):null;if(o===null)continue;let s=t?.handle===e?a.by.map((e,n)=>e-t.by[n]):[0,0,0],c=t?.handle===e?t.start:n.place(o);r.push(...c.map((e,t)=>e+s[t])),i.push(1)}}e.view.showHandles(r,i)}};function B(t){let{region:n}=t.layer;if(!n){t.showMessage(e.pinNothing);return}let r=t.doc.pose??ge;t.history.commit({...t.doc,pose:ye(r,[...ve(r),n])})}function Ce(t){let r=o(e.grabMode,e.grabModes,fe.mode,t=>{fe.mode=t,r.set(t),i.textContent=e.grabHints[t]}),i=n(`p`,{class:`hint`},e.grabHints[fe.mode]),a=n(`p`,{class:`hint`,role:`status`}),s=e=>t.history.commit({...t.doc,pose:e}),c=n(`button`,{type:`button`,onclick:()=>{let{pose:e}=t.doc;e&&s({...e,handle:e.handle.slice(0,-1)})}},e.removeHandle),l=n(`button`,{type:`button`,onclick:()=>s(null)},e.straighten),u=n(`button`,{type:`button`,onclick:()=>B(t)},e.pinRegion);return t.on([`doc`,`shape`],()=>{let{pose:n}=t.doc;a.textContent=e.grabCount(n?.handle.length??0,n?ve(n).length:0),c.disabled=!n||n.handle.length===0,l.disabled=n===null}),n(`div`,{class:`grab-panel`,role:`group`,"aria-label":e.grab},r,i,a,n(`div`,{class:`row`},u,c,l))}function V(e,t){if(typeof e==`number`)return e;let n=e.trim();return n.endsWith(`%`)?Number(n.slice(0,-1))/100*t:Number(n)}function H(e,t=3){if(!Number.isFinite(e))return`–`;if(e===0)return`0`;let n=Math.abs(e);return n>=1e5||n<1e-4?e.toExponential(Math.max(0,t-1)).replace(`e+`,`e`).replace(`-`,`−`):Number(e.toPrecision(t)).toString().replace(`-`,`−`)}function we(e){return Math.round(e).toString().replace(/\B(?=(\d{3})+$)/g,` `)}function Te({inward:e}){return(e??[]).length>0}function Ee({inward:e,n_triangles:t}){return 2*(e??[]).reduce((e,t)=>e+t.n_faces,0)>t}var De=.15,U={effect:`smooth`,radius:5,strength:1,falloff:1,mode:`add`,symmetric:!1,frontOnly:!1},Oe=.2,ke=.25;function Ae(e,t,n){let r=Ee(e.shape)?-1:1,i=U.mode===`subtract`?`add`:`subtract`,{diagonal:a,center:o}=e.shape,s=U.radius/100*a*t,c=Math.abs(o[0])<.02*a?-o[0]:0;return{radius:s,falloff:U.falloff*s,strength:U.strength,mode:n?i:U.mode,facing:U.frontOnly&&e.shape.kind===`mesh`?{direction:e.view.camera.toward().map(e=>e*r),falloff:Oe}:null,mirror:U.symmetric?c:null}}function je(e){return e.radius-e.falloff/2}function Me(e){return ke*e.radius}function Ne(e,t){let n={vertices:{indices:e,radius:t.radius,falloff:t.falloff}},r=t.facing?{all:[n,{facing:t.facing}]}:n,i=t.strength<1?{faded:{factor:t.strength,region:r}}:r;return t.mode===`smooth`?{smooth:{region:i,by:Me(t)}}:t.mode===`subtract`?{subtract:i}:{add:i}}function Pe(e,t,n){return{painted:[...e?`painted`in e?e.painted:[{add:e}]:[],Ne(t,n)]}}function Fe(e){if(!(`painted`in e))return[];let t=e.painted.at(-1),n=`add`in t?t.add:`subtract`in t?t.subtract:t.smooth.region;return`faded`in n&&(n=n.faded.region),`all`in n&&(n=n.all[0]),`vertices`in n?n.vertices.indices:[]}function Ie(e){return e===`match`||e===`clone`}function Le(t){let r=s(e.radius,{min:.5,max:30,step:.5,value:U.radius},e=>t.shape?H(e/100*t.shape.diagonal):`${e} %`,e=>{U.radius=e});r.classList.add(`radius`);let i=o(e.brushMode,[[`add`,e.add],[`subtract`,e.subtract],[`smooth`,e.smooth]],null,e=>{U.mode=e,t.setTool(`brush`)});t.on(`tool`,()=>{h.classList.toggle(`grabbing`,t.isGrabOn),m.textContent=t.isGrabOn?e.grab:e.brush,h.classList.toggle(`cloning`,U.effect===`clone`),r.set(U.radius),i.set(t.isBrushOn?U.mode:null)});let a=()=>t.target!==null||!!t.shape?.graph,c=[`smooth`,`enhance`,`flatten`,`match`,`clone`,`region`].map(r=>n(`button`,{type:`button`,"data-effect":r,title:e.effectHints[r],onclick:()=>{a()&&Ie(r)||(U.effect=r,t.setTool(`brush`))}},e.effects[r])),u=n(`p`,{class:`hint`}),d=n(`button`,{type:`button`,onclick:()=>U.effect===`clone`?t.pickCloneSource():t.detail.startPick()},e.pickDetail);t.on(`tool`,()=>{for(let e of c)e.setAttribute(`aria-pressed`,String(t.isBrushOn&&e.dataset.effect===U.effect)),e.hidden=a()&&Ie(e.dataset.effect);u.textContent=t.isBrushOn?e.effectHints[U.effect]:e.brushOff,d.hidden=!t.isBrushOn||U.effect!==`match`&&U.effect!==`clone`}),t.on(`target`,()=>{a()&&Ie(U.effect)&&(U.effect=`smooth`),t.emit(`tool`)});let f=l(e.frontOnly,!1,e=>{U.frontOnly=e});t.on(`shape`,()=>{r.set(U.radius),t.emit(`tool`),f.hidden=t.shape.kind!==`mesh`});let p=s(e.falloff,{min:0,max:100,step:5,value:100},e=>`${e} %`,e=>{U.falloff=e/100});p.classList.add(`falloff`);let m=n(`h2`,{},e.brush),h=n(`section`,{class:`brush-panel`,id:`brush`,role:`tabpanel`,"aria-label":e.brush},n(`header`,{},m),Ce(t),n(`div`,{class:`effects`,role:`group`,"aria-label":e.effect},...c),u,d,i,r,s(e.strength,{min:5,max:100,step:5,value:100},e=>`${e} %`,e=>{U.strength=e/100}),p,l(e.symmetry,!1,e=>{U.symmetric=e}),f);return h}function Re(e){let t=Math.min(200,Math.max(0,e))/100,n=t<=1?t:4**(t-1);return Math.round(n*1e3)/1e3}function ze(e){if(!(e>0))return 0;let t=e<=1?e:1+Math.log(e)/Math.log(4);return Math.min(200,Math.round(100*t))}function Be(e){return e.toFixed(e>=10?1:2)}function Ve({gains:t,preset:n},r,i=`all`){let a=r.find(e=>e.name===n),o=t.reduce((e,t,n)=>e+Number(t!==(a?.gains[n]??1)),0);return a&&o<t.length?e.presetChanged(e.presetNames[a.name]??a.name,o):i===`all`&&o>0?e.bandsChanged(o):``}var He=12;function Ue(e,t){let n=e.fields.find(e=>e.name===t),r=n?.series?.name;return!n||r===void 0?n?[n]:[]:e.fields.filter(e=>e.series?.name===r)}function We(e,t){if(e===null)return``;let n=e*t;return e>=.1||n===0?`${H(n,4)} s`:`${H(1e3*n,4)} ms`}function Ge(e){let t=null,n=null,r=async()=>{try{for(;t;){let n=t;t=null,await e(...n)}}finally{n=null}};return{clear:()=>{t=null},show:(e,i)=>(t=[e,i],n?Promise.resolve():(n=r(),n)),waitUntilShown:()=>n??Promise.resolve()}}function Ke(t){let r=[],i=0,o=0,s=0,c=n(`output`,{}),l=n(`input`,{type:`range`,min:`0`,max:`0`,step:`1`,"aria-label":e.frameSlider}),u=a(`play`,e.play,()=>o?_():void g()),d=n(`div`,{class:`frame-bar`,hidden:!0},u,l,c),f=Ge(t),p=e=>f.show(r[i],e);function m(t){i=t,l.value=String(t);let n=We(r[t]?.series?.step??null,t);c.textContent=e.frameOf(t+1,r.length,n),l.setAttribute(`aria-valuetext`,c.textContent)}function h(t){o=t?++s:0,u.setAttribute(`aria-pressed`,String(t)),u.setAttribute(`aria-label`,t?e.pause:e.play),u.title=t?e.pause:e.play,u.classList.toggle(`playing`,t)}async function g(){h(!0);let e=o;for(;o===e&&r.length>1;){let t=performance.now()+1e3/He;m((i+1)%r.length),await p(!1),await new Promise(e=>setTimeout(e,Math.max(0,t-performance.now()))),document.hidden&&o===e&&_()}}function _(){h(!1),p(!0)}return l.addEventListener(`input`,()=>{o&&h(!1),m(l.valueAsNumber),p(!1)}),l.addEventListener(`change`,()=>void p(!0)),{element:d,set:(e,t)=>{(e.length!==r.length||e[0]?.name!==r[0]?.name)&&(f.clear(),o&&h(!1)),r=e,d.hidden=r.length<2,l.max=String(Math.max(0,r.length-1)),!d.hidden&&!o&&m(Math.max(0,t))},step:e=>{r.length<2||(m(Math.min(r.length-1,Math.max(0,i+e))),_())},stop:()=>{o&&h(!1)},waitUntilShown:f.waitUntilShown}}function qe({from:e,to:t,step:n}){return[Math.ceil((t[0]-e[0])/n),Math.ceil((t[1]-e[1])/n)]}function Je(e,{index:t,frame:n,from:r,to:i,step:a}){let o=e.fixed===null?``:`&index=${t}`,s=n===null?``:`&frame=${n}`;return`axes=${e.axes}&from=${r}&to=${i}&step=${a}${o}${s}`}var Ye=class{part;nChannels;rows;columns;values;edited;bands;constructor(e,t,n){this.part=e,this.nChannels=t,[this.rows,this.columns]=qe(e);let r=this.rows*this.columns*t;if(r===0||n.length%r!==0)throw Error(`a plane of ${r} values has ${n.length}`);this.values=n.subarray(0,r),this.edited=this.values.slice(),this.bands=[];for(let e=r;e<n.length;e+=r)this.bands.push(n.subarray(e,e+r))}get nLevels(){return this.bands.length}edit(e){let{edited:t,values:n}=this;t.set(n);for(let[n,r]of this.bands.entries()){let i=(e[n]??1)-1;if(i!==0)for(let e=0;e<t.length;e++)t[e]+=i*r[e]}}at(e,t){let{from:n,step:r}=this.part,i=Math.round((e-n[0])/r),a=Math.round((t-n[1])/r);return i<0||a<0||i>=this.rows||a>=this.columns?-1:i*this.columns+a}spectrumAt(e){let t=Array.from({length:this.nChannels},(t,n)=>e*this.nChannels+n);return this.bands.map(e=>Math.max(...t.map(t=>Math.abs(e[t]))))}};function Xe(e,t){return[0,1,2].map(n=>t.reduce((t,r,i)=>t+r*e.steps[i][n],e.origin[n]))}function Ze(e,t,n,r){let i=(t,n)=>Math.min(e[n],Math.max(0,t)),a=[i(Math.floor(t.low[0]),0),i(Math.floor(t.low[1]),1)],o=[i(Math.ceil(t.high[0])+1,0),i(Math.ceil(t.high[1])+1,1)];if(o[0]<=a[0]||o[1]<=a[1])return null;let s=e[0]*e[1]<=n,c=[0,1].map(t=>s?e[t]:Math.ceil((o[t]-a[t])/4)),l=s?1:Math.max(1,Math.floor(t.perPixel)),u=[i(a[0]-c[0],0),i(a[1]-c[1],1)],d=[i(o[0]+c[0],0),i(o[1]+c[1],1)];for(;Math.ceil((d[0]-u[0])/l)*Math.ceil((d[1]-u[1])/l)>n;)l++;return r!==null&&r.step<=l&&[0,1].every(e=>r.from[e]<=a[e]&&r.to[e]>=o[e])?null:{index:0,frame:null,from:u,to:d,step:l}}var Qe=1e3;function $e(t){let r=(e,r)=>{let i=n(`input`,{type:`text`,inputMode:`decimal`,"aria-label":e}),s=n(`input`,{type:`range`,min:`0`,max:String(Qe),step:`1`,"aria-label":e}),c=e=>{let n=[...t.look.window];n[r]=e,Number.isFinite(e)&&n[1]>n[0]&&t.setLook({window:n}),o()};return s.addEventListener(`input`,()=>{let[e,t]=a();c(e+(t-e)*s.valueAsNumber/Qe)}),i.addEventListener(`change`,()=>c(Number(i.value.replace(`,`,`.`).replace(`−`,`-`)))),{number:i,range:s,row:n(`div`,{class:`window-row`},n(`span`,{},e),i,s)}},i=[r(e.windowLow,0),r(e.windowHigh,1)];function a(){let{least:e,greatest:n}=t.grid.range,[r,i]=t.look.window;return[Math.min(e,r),Math.max(n,i)]}function o(){if(!t.grid)return;let[e,n]=a();for(let[r,{number:a,range:o}]of i.entries()){let i=t.look.window[r];document.activeElement!==a&&(a.value=H(i,5)),o.value=String(Math.round(Qe*(i-e)/(n-e||1))),o.setAttribute(`aria-valuetext`,H(i,5))}}let s=e=>{let{least:n,greatest:r,low:i,high:a}=t.grid.range,[s,c]=e===`most`?[i,a]:[n,r];t.setLook({window:c>s?[s,c]:[s,s+1]}),o()},c=(e,t,r)=>n(`button`,{type:`button`,title:r,onclick:()=>s(t)},e),l=n(`div`,{class:`row`},c(e.windowAuto,`most`,e.windowAutoHint),c(e.windowAll,`all`));return{rows:[...i.map(({row:e})=>e),l],show:o}}function et(t){let r=n(`div`,{class:`stack`}),i=[];return{list:r,rebuild:n=>{let a=n.views.filter(e=>e.fixed!==null).map(({name:r,fixed:i})=>{let a=n.sizes[i]-1,o=e=>`${e} / ${a}`,c={min:0,max:a,step:1,value:t.cross[i]};return{axis:i,row:s(e.slice(r),c,o,e=>t.step(i,e-t.cross[i]))}});i=a.map(({axis:e,row:t})=>({axis:e,set:t.set})),r.replaceChildren(...a.map(({row:e})=>e))},show:()=>{for(let{axis:e,set:n}of i)n(t.cross[e])}}}function tt(t,r){let i=n(`dl`,{class:`facts`}),a=n(`p`,{class:`hint`},e.placeHint),o=()=>{let{grid:o,place:s}=r;if(a.hidden=s!==null,i.hidden=s===null,!o||!s)return;let c=t=>t.some(Number.isNaN)?e.noData:t.map(e=>H(e,5)).join(`, `),l=nt(o),u=Xe(o,s.at).slice(0,Math.max(2,o.sizes.length)),d=s.at.map((e,t)=>`${o.axes[t]} ${e}`).join(`, `),f=(e,t)=>[n(`dt`,{},e),n(`dd`,{},t)],{frames:p}=o,m=t=>e.frameOf(t+1,p.n,We(p.step,t)),h=s.after.some((e,t)=>e!==s.before[t])&&!Number.isNaN(s.before[0]);i.replaceChildren(...f(e.valueHere,c(t.view.showsOriginal?s.before:s.after)),...h?f(e.valueOfFile,c(s.before)):[],...s.frame===null?[]:f(e.frameSlider,m(s.frame)),...f(e.indexHere,d),...f(e.positionHere(l),u.map(e=>H(e,6)).join(`, `)))};return r.onPlace(o),t.on([`shape`,`before`],o),n(`div`,{},a,i)}function nt({unit:t}){return(t&&e.lengthUnits[t])??t??``}function rt(t){let r=n(`dl`,{class:`facts`});return t.on([`shape`,`moved`],()=>{let i=t.shape?.grid;if(!i)return;let a=(e,t)=>[n(`dt`,{},e),n(`dd`,{},t)],o=t.displacement,s=nt(i),c=i.spacings.map(e=>H(e,4)).join(` × `);r.replaceChildren(...a(e.fieldGreatest,o?H(o.greatest):`0`),...a(e.fieldRms,o?H(o.rms):`0`),...a(e.gridSizes(i.axes.join(` × `)),i.sizes.join(` × `)),...a(e.gridSpacings,s?`${c} ${s}`:c),...i.frames?a(e.gridFrames,e.framesEvery(i.frames.n,We(i.frames.step,1))):[],...a(e.gridNumbers,e.numberTypes[i.value_type]??i.value_type),...i.n_missing>0?a(e.gridMissing,String(i.n_missing)):[])}),r}function it(t,r){let i=n(`div`,{}),a=s(e.relief,{min:-40,max:40,step:1,value:0},e=>`${H(10**(e/40),2)} ×`,e=>r.setLook({relief:10**(e/40)})),c=l(e.smoothPixels,!1,e=>r.setLook({smooth:e})),u=$e(r),d=et(r),f=n(`div`,{class:`stack`},...u.rows),p=()=>{f.hidden=r.look.mode===`relief`,a.hidden=r.look.mode!==`relief`},m=n(`h3`,{},e.slices);t.on(`shape`,()=>{let n=t.shape?.grid;if(!n)return;let s=n.sizes.length===2,l=[...n.n_channels>=3?[[`color`,e.shadeModes.color]]:[],[`gray`,e.shadeModes.gray],[`map`,e.shadeModes.map],...s&&n.n_channels===1?[[`relief`,e.shadeModes.relief]]:[]],f=o(e.shadeMode,l,r.look.mode,e=>{r.setLook({mode:e}),f.set(e),p()});i.replaceChildren(f),m.hidden=s,d.list.hidden=s,d.rebuild(n),a.set(Math.round(40*Math.log10(r.look.relief))),c.querySelector(`input`).checked=r.look.smooth,u.show(),p()}),r.onPlace(d.show);let h=(e,t,r)=>n(`button`,{type:`button`,"aria-label":t,title:t,onclick:r},e);return n(`section`,{id:`grid`,role:`tabpanel`,"aria-label":e.look},n(`h2`,{},e.look),i,f,a,c,n(`div`,{class:`row`},h(`−`,e.zoomOut,()=>r.enlarge(.8)),h(`+`,e.zoomIn,()=>r.enlarge(1.25)),n(`button`,{type:`button`,onclick:()=>r.fitAll()},e.fitAll)),m,d.list,n(`h3`,{},e.placeTitle),tt(t,r),n(`h3`,{},e.aboutGrid),rt(t))}function at(t,...r){let i=n(`dialog`,{"aria-label":t});return i.append(n(`header`,{},n(`h2`,{},t),a(`close`,e.close,()=>i.close())),n(`div`,{class:`content`},...r)),i.addEventListener(`close`,()=>i.remove()),i.addEventListener(`pointerdown`,e=>{if(e.target!==i)return;let t=i.getBoundingClientRect();(e.clientX<t.left||e.clientX>t.right||e.clientY<t.top||e.clientY>t.bottom)&&i.close()}),document.body.append(i),i.showModal(),i}var ot={count:24,voices:8};function st(t,n,r){let i=(e,t)=>{let n=Number(e);return e.trim()!==``&&Number.isInteger(n)&&n>=1&&n<=t?n:null};if(t===`auto`)return{};if(t===`count`){let t=i(n.count,ot.count);if(t===null)return e.badCount(ot.count);let r=i(n.voices,ot.voices);return r===null?e.badVoices(ot.voices):r>1?{levels:t,voices:r}:{levels:t}}let a=n.lengths.split(/[,;\s]+/).map(e=>e.replace(`−`,`-`)).filter(e=>e!==``),o=a.find(e=>!(V(e,r)>0&&/^[\d.e+-]+%?$/i.test(e)));if(o!==void 0)return e.badWidth(o);let s=a.map(e=>V(e,r));return s.length===0||s.some((e,t)=>t>0&&e<=s[t-1])?e.badLengths:{lengths:a.map(e=>e.endsWith(`%`)?e:Number(e))}}function ct(t){let{shape:r}=t;if(!r)return;let i=n(`select`,{"aria-label":e.levelsHow,onchange:()=>f()},n(`option`,{value:`auto`},e.levelsAuto),n(`option`,{value:`count`},e.levelsCount),n(`option`,{value:`lengths`},e.levelsLengths)),{choice:a}=r,o=n(`input`,{type:`number`,min:`1`,max:String(ot.count),value:String(Math.min(ot.count,a.levels??r.levels.length))}),s=n(`input`,{type:`number`,min:`1`,max:String(ot.voices),value:`1`}),c=n(`input`,{type:`text`,value:r.levels.map(e=>H(e.sigma).replace(`−`,`-`)).join(`, `)}),l=n(`div`,{class:`stack`},n(`label`,{class:`field`},n(`span`,{},e.levelsHowMany),o),n(`label`,{class:`field`},n(`span`,{},e.voices),s)),u=n(`label`,{class:`stack`},n(`span`,{},e.lengthsHint),c),d=n(`p`,{class:`problem`,role:`alert`,hidden:!0}),f=()=>{l.hidden=i.value!==`count`,u.hidden=i.value!==`lengths`,d.hidden=!0};f();let p=e=>{d.textContent=e,d.hidden=!1},m=async()=>{let e={count:o.value,voices:s.value,lengths:c.value},n=st(i.value,e,r.diagonal);if(typeof n==`string`)p(n);else{h.close();try{await t.session.setLevels(n)}catch(e){document.body.append(h),h.showModal(),p(e.message)}}},h=at(e.levels,n(`p`,{},e.levelsNote),n(`label`,{class:`field`},n(`span`,{},e.levelsHow),i),l,u,d,n(`div`,{class:`actions`},n(`button`,{type:`button`,class:`primary`,onclick:()=>void m()},e.apply)))}var lt=16,ut=4;function dt(e,t,n,r){e.timings.startSliderTiming(),e.target===null&&e.markMoving();let i=e.withGain(t,n);r?(e.history.preview(i),e.history.end()):e.history.preview(i)}var ft=class{studio;gainsBefore=new Map;constructor(e){this.studio=e}toggle(e){let{studio:t,gainsBefore:n}=this,{gains:r,key:i}=t.layer,a=`${i}.${e}`,o=r[e-1];o!==0&&n.set(a,o);let s=o===0?n.get(a)||1:0;t.changeLayer({gains:r.with(e-1,s)},!0)}};function pt(t,r,{level:i,sigma:a},o){let s=H(a),c=e.band(i,s),l=n(`input`,{type:`range`,class:`gain`,min:`0`,max:`200`,step:`1`,"aria-label":c,"aria-orientation":`vertical`,"aria-keyshortcuts":`s m`,title:e.sliderHint,disabled:!0,oninput:()=>dt(t,i,Re(l.valueAsNumber),!1),onchange:()=>t.history.end(),onpointerup:()=>t.history.end(),ondblclick:()=>dt(t,i,1,!0),onkeydown:e=>{if(e.ctrlKey||e.metaKey||e.altKey)return;let n=e.key.toLowerCase();if(n===`s`)t.setSolo(i);else if(n===`m`)r.toggle(i);else return;e.preventDefault(),e.stopPropagation()}}),u=n(`input`,{class:`number`,type:`text`,inputMode:`decimal`,"aria-label":e.gainOf(c),disabled:!0,onchange:()=>{let n=Number(u.value.replace(`,`,`.`));u.value.trim()!==``&&n>=0&&n<=100?dt(t,i,n,!0):t.showMessage(e.badGain(100),`error`),o(),u.value=Be(t.layer.gains[i-1]??1)}}),d=n(`i`,{class:`meter`}),f=n(`button`,{type:`button`,"aria-label":e.solo(c),title:e.solo(c),"aria-pressed":`false`,tabIndex:-1,onclick:()=>t.setSolo(i)},`S`),p=n(`button`,{type:`button`,"aria-label":e.mute(c),title:e.mute(c),"aria-pressed":`false`,tabIndex:-1,onclick:()=>r.toggle(i)},`M`),m=n(`span`,{class:`sigma`,title:e.sigma(s)},s);return{root:n(`div`,{class:`band`,"data-level":String(i)},u,n(`div`,{class:`track`},n(`div`,{class:`rail`},d,n(`i`,{class:`fill`})),l),n(`div`,{class:`sm`},f,p),m),input:l,number:u,meter:d,sigma:m,solo:f,mute:p}}function mt(e,t,n,r){let i=null,a=t=>{let r=n().findIndex(e=>{let n=e.root.getBoundingClientRect();return t.clientX>=n.left&&t.clientX<n.right});if(r<0||!e.isBandReady(r+1))return;let a=n()[r].input.getBoundingClientRect(),o=Math.round(200*Math.min(1,Math.max(0,(a.bottom-8-t.clientY)/(a.height-16)))),s=Math.abs(o-100)<4?100:o,c=i??{level:r+1,position:s},l,u=Math.abs(r+1-c.level);for(let t=0;t<=u;t++){let n=c.level+(u?t*Math.sign(r+1-c.level):0),i=u?c.position+(s-c.position)*t/u:s;e.isBandReady(n)&&(l=e.withGain(n,Re(Math.round(i)),l))}i={level:r+1,position:s},l&&(e.timings.startSliderTiming(),e.target===null&&e.markMoving(),e.history.preview(l))};t.addEventListener(`pointerdown`,e=>{r()&&!e.target.closest(`button, .number`)&&(e.preventDefault(),t.setPointerCapture(e.pointerId),i=null,a(e))}),t.addEventListener(`pointermove`,e=>{t.hasPointerCapture(e.pointerId)&&a(e)});for(let n of[`pointerup`,`pointercancel`])t.addEventListener(n,n=>{t.hasPointerCapture(n.pointerId)&&(t.releasePointerCapture(n.pointerId),e.history.end())})}function ht(t,n){let r=Math.max(...n,0);for(let[i,a]of t.entries()){let t=n[i]??0;a.meter.style.height=r>0?`${100*t/r}%`:`0`,a.root.title=t>0?e.detailHere(H(t)):``}}function gt(t,n,r){for(let[i,a]of t.entries()){let t=n[i]??1,o=String(ze(t));a.input.value!==o&&Re(a.input.valueAsNumber)!==t&&(a.input.value=o),a.input.setAttribute(`aria-valuetext`,e.times(Be(t))),a.root.style.setProperty(`--at`,String(Number(o)/200)),document.activeElement!==a.number&&(a.number.value=Be(t)),a.root.classList.toggle(`changed`,t!==1),a.root.classList.toggle(`unheard`,r!==null&&r!==i+1),a.mute.setAttribute(`aria-pressed`,String(t===0)),a.solo.setAttribute(`aria-pressed`,String(r===i+1))}}function _t(t){let n=o(e.target,[[`positions`,e.positions],[`field`,e.fieldTarget]],`positions`,e=>{e===`positions`?t.setTarget(null):t.shownField===null?t.showFirstField():t.setTarget(t.shownField)});n.classList.add(`target`);let r=n.querySelector(`button:first-child`),i=n.querySelector(`button:last-child`),a=()=>{let{target:a,shownField:o,shape:s}=t;n.hidden=!s?.fields.some(e=>e.editable),r.hidden=s?.graph?.placed===!0,n.set(a===null?`positions`:`field`),i.textContent=a??o??e.fieldTarget,i.title=e.fieldTargetHint};return t.on([`shape`,`levels`,`fields`,`target`],a),a(),n}function vt(t){let r=[],i=!1,a=new ft(t),o=n(`div`,{class:`bands`,role:`group`,"aria-label":e.equalizer}),s=n(`select`,{"aria-label":e.presets}),c=n(`button`,{type:`button`,"aria-pressed":`false`,title:e.drawHint},e.draw),l=n(`span`,{class:`whose`}),u=n(`span`,{},e.axis);t.on(`shape`,()=>{let n=t.shape?.grid,r=t.shape?.graph?.placed;u.textContent=n?e.gridAxis(nt(n)):r?e.graphAxis:e.axis}),c.addEventListener(`click`,()=>{i=!i,c.setAttribute(`aria-pressed`,String(i)),o.classList.toggle(`drawing`,i)}),s.addEventListener(`change`,()=>{let n=t.shape?.presets[Number(s.value)];if(d(),!n)return;t.changeLayer({gains:O(n.gains,t.nLevels),preset:n.name},!0);let r=(t.isGrid?e.gridPresetNotes:e.presetNotes)[n.name];r&&t.showMessage(r)});function d(){s.value=``;let n=Ve(t.layer,t.shape?.presets??[],`presets`);s.options[0].textContent=n||e.presets,s.classList.toggle(`named`,n!==``)}function f(){r=(t.shape?.levels??[]).map(e=>pt(t,a,e,h)),o.replaceChildren(...r.map(e=>e.root)),o.classList.toggle(`many`,r.length>lt),o.style.setProperty(`--columns`,String(r.length)),p(),s.replaceChildren(n(`option`,{value:``},e.presets),...(t.shape?.presets??[]).map((t,r)=>n(`option`,{value:String(r)},e.presetNames[t.name]??t.name))),m(),h()}function p(){let e=r[0]?.root.offsetWidth;if(!e)return;let t=Math.ceil((Math.max(...r.map(e=>e.sigma.offsetWidth))+ut)/e);for(let[e,n]of r.entries())n.root.classList.toggle(`unlabeled`,(r.length-1-e)%t!=0)}function m(){for(let[e,n]of r.entries()){let r=t.isBandReady(e+1);n.input.disabled=!r,n.number.disabled=!r,n.root.classList.toggle(`waiting`,!r)}}function h(){s.options.length>0&&d();let{solo:n}=t;gt(r,t.layer.gains,n?.key===t.selected?n.level:null);let{layer:i,layers:a}=t,o=a.findIndex(e=>e.key===i.key);l.textContent=a.length>1?i.name||e.layerName(o+1):``}return mt(t,o,()=>r,()=>i),new ResizeObserver(p).observe(o),t.on(`levels`,f),t.on(`band`,m),t.on([`doc`,`selected`,`solo`,`target`],h),t.on(`spectrum`,()=>ht(r,t.spectrum)),n(`section`,{class:`equalizer`,id:`equalizer`,"aria-label":e.equalizer},n(`header`,{},n(`h2`,{},e.equalizer),_t(t),l,n(`span`,{class:`space`}),c,s,n(`button`,{type:`button`,onclick:()=>t.changeLayer({gains:O([],t.nLevels),preset:void 0},!0)},e.reset),n(`button`,{type:`button`,onclick:()=>ct(t)},e.levels)),n(`div`,{class:`desk`},n(`div`,{class:`scale`,"aria-hidden":`true`},...[`4`,`2`,`1`,`½`,`0`].map(e=>n(`span`,{},e))),o),n(`footer`,{},n(`span`,{},e.fine),n(`span`,{class:`axis`},u,n(`span`,{class:`meter-legend`},e.meters)),n(`span`,{},e.coarse)))}var yt=1e3,bt=1001,xt=1002,St=1003,Ct=1004,wt=1005,Tt=1006,Et=1007,Dt=1008,Ot=1009,kt=1010,At=1011,jt=1012,Mt=1013,Nt=1014,Pt=1015,Ft=1016,It=1017,Lt=1018,Rt=1020,zt=35902,Bt=35899,Vt=1021,Ht=1022,Ut=1023,Wt=1026,Gt=1027,Kt=1028,qt=1029,Jt=1030,Yt=1031,Xt=1033,Zt=33776,Qt=33777,$t=33778,en=33779,tn=35840,nn=35841,rn=35842,an=35843,on=36196,sn=37492,cn=37496,ln=37488,un=37489,dn=37490,fn=37491,pn=37808,mn=37809,hn=37810,gn=37811,_n=37812,vn=37813,yn=37814,bn=37815,xn=37816,Sn=37817,Cn=37818,wn=37819,Tn=37820,En=37821,Dn=36492,On=36494,kn=36495,An=36283,jn=36284,Mn=36285,Nn=36286,Pn=2300,Fn=2301,In=2302,Ln=2303,Rn=2400,zn=2401,Bn=2402,Vn=3200,Hn=`srgb`,Un=`srgb-linear`,Wn=`linear`,Gn=`srgb`,Kn=7680,qn=35044,Jn=`300 es`,Yn=2e3;function Xn(e){for(let t=e.length-1;t>=0;--t)if(e[t]>=65535)return!0;return!1}function Zn(e){return ArrayBuffer.isView(e)&&!(e instanceof DataView)}function Qn(e){return document.createElementNS(`http://www.w3.org/1999/xhtml`,e)}function $n(){let e=Qn(`canvas`);return e.style.display=`block`,e}var er={};function tr(...e){let t=`THREE.`+e.shift();console.log(t,...e)}function nr(e){let t=e[0];if(typeof t==`string`&&t.startsWith(`TSL:`)){let t=e[1];t&&t.isStackTrace?e[0]+=` `+t.getLocation():e[1]=`Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.`}return e}function W(...e){e=nr(e);let t=`THREE.`+e.shift();{let n=e[0];n&&n.isStackTrace?console.warn(n.getError(t)):console.warn(t,...e)}}function G(...e){e=nr(e);let t=`THREE.`+e.shift();{let n=e[0];n&&n.isStackTrace?console.error(n.getError(t)):console.error(t,...e)}}function rr(...e){let t=e.join(` `);t in er||(er[t]=!0,W(...e))}function ir(e,t,n){return new Promise(function(r,i){function a(){switch(e.clientWaitSync(t,e.SYNC_FLUSH_COMMANDS_BIT,0)){case e.WAIT_FAILED:i();break;case e.TIMEOUT_EXPIRED:setTimeout(a,n);break;default:r()}}setTimeout(a,n)})}var ar={0:0,2:6,4:4,3:5,1:1,6:2,7:7,5:3},or=class{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[e]===void 0&&(n[e]=[]),n[e].indexOf(t)===-1&&n[e].push(t)}hasEventListener(e,t){let n=this._listeners;return n!==void 0&&n[e]!==void 0&&n[e].indexOf(t)!==-1}removeEventListener(e,t){let n=this._listeners;if(n===void 0)return;let r=n[e];if(r!==void 0){let e=r.indexOf(t);e!==-1&&r.splice(e,1)}}dispatchEvent(e){let t=this._listeners;if(t===void 0)return;let n=t[e.type];if(n!==void 0){e.target=this;let t=n.slice(0);for(let n=0,r=t.length;n<r;n++)t[n].call(this,e);e.target=null}}},sr=`00.01.02.03.04.05.06.07.08.09.0a.0b.0c.0d.0e.0f.10.11.12.13.14.15.16.17.18.19.1a.1b.1c.1d.1e.1f.20.21.22.23.24.25.26.27.28.29.2a.2b.2c.2d.2e.2f.30.31.32.33.34.35.36.37.38.39.3a.3b.3c.3d.3e.3f.40.41.42.43.44.45.46.47.48.49.4a.4b.4c.4d.4e.4f.50.51.52.53.54.55.56.57.58.59.5a.5b.5c.5d.5e.5f.60.61.62.63.64.65.66.67.68.69.6a.6b.6c.6d.6e.6f.70.71.72.73.74.75.76.77.78.79.7a.7b.7c.7d.7e.7f.80.81.82.83.84.85.86.87.88.89.8a.8b.8c.8d.8e.8f.90.91.92.93.94.95.96.97.98.99.9a.9b.9c.9d.9e.9f.a0.a1.a2.a3.a4.a5.a6.a7.a8.a9.aa.ab.ac.ad.ae.af.b0.b1.b2.b3.b4.b5.b6.b7.b8.b9.ba.bb.bc.bd.be.bf.c0.c1.c2.c3.c4.c5.c6.c7.c8.c9.ca.cb.cc.cd.ce.cf.d0.d1.d2.d3.d4.d5.d6.d7.d8.d9.da.db.dc.dd.de.df.e0.e1.e2.e3.e4.e5.e6.e7.e8.e9.ea.eb.ec.ed.ee.ef.f0.f1.f2.f3.f4.f5.f6.f7.f8.f9.fa.fb.fc.fd.fe.ff`.split(`.`),cr=Math.PI/180,lr=180/Math.PI;function ur(){let e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,n=Math.random()*4294967295|0,r=Math.random()*4294967295|0;return(sr[e&255]+sr[e>>8&255]+sr[e>>16&255]+sr[e>>24&255]+`-`+sr[t&255]+sr[t>>8&255]+`-`+sr[t>>16&15|64]+sr[t>>24&255]+`-`+sr[n&63|128]+sr[n>>8&255]+`-`+sr[n>>16&255]+sr[n>>24&255]+sr[r&255]+sr[r>>8&255]+sr[r>>16&255]+sr[r>>24&255]).toLowerCase()}function K(e,t,n){return Math.max(t,Math.min(n,e))}function dr(e,t){return(e%t+t)%t}function fr(e,t,n){return(1-n)*e+n*t}function pr(e){return 2**Math.floor(Math.log(e)/Math.LN2)}function mr(e){switch(e.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function hr(e,t){if(t.constructor===Float32Array)return e;let n=mr(t);if(n===void 0)throw Error(`THREE.MathUtils: Invalid component type.`);return Math.max(e/n,-1)}function gr(e,t){if(t.constructor===Float32Array)return e;let n=mr(t);if(n===void 0)throw Error(`THREE.MathUtils: Invalid component type.`);return Math.round(e*n)}var q=class{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw Error(`THREE.Vector2: index is out of range: `+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw Error(`THREE.Vector2: index is out of range: `+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){let t=this.x,n=this.y,r=e.elements;return this.x=r[0]*t+r[3]*n+r[6],this.y=r[1]*t+r[4]*n+r[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=K(this.x,e.x,t.x),this.y=K(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=K(this.x,e,t),this.y=K(this.y,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(K(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(K(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y;return t*t+n*n}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){let n=Math.cos(t),r=Math.sin(t),i=this.x-e.x,a=this.y-e.y;return this.x=i*n-a*r+e.x,this.y=i*r+a*n+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},_r=class{constructor(e=0,t=0,n=0,r=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=n,this._w=r}static slerpFlat(e,t,n,r,i,a,o){let s=n[r+0],c=n[r+1],l=n[r+2],u=n[r+3],d=i[a+0],f=i[a+1],p=i[a+2],m=i[a+3];if(u!==m||s!==d||c!==f||l!==p){let e=s*d+c*f+l*p+u*m;e<0&&(d=-d,f=-f,p=-p,m=-m,e=-e);let t=1-o;if(e<.9995){let n=Math.acos(e),r=Math.sin(n);t=Math.sin(t*n)/r,o=Math.sin(o*n)/r,s=s*t+d*o,c=c*t+f*o,l=l*t+p*o,u=u*t+m*o}else{s=s*t+d*o,c=c*t+f*o,l=l*t+p*o,u=u*t+m*o;let e=1/Math.sqrt(s*s+c*c+l*l+u*u);s*=e,c*=e,l*=e,u*=e}}e[t]=s,e[t+1]=c,e[t+2]=l,e[t+3]=u}static multiplyQuaternionsFlat(e,t,n,r,i,a){let o=n[r],s=n[r+1],c=n[r+2],l=n[r+3],u=i[a],d=i[a+1],f=i[a+2],p=i[a+3];return e[t]=o*p+l*u+s*f-c*d,e[t+1]=s*p+l*d+c*u-o*f,e[t+2]=c*p+l*f+o*d-s*u,e[t+3]=l*p-o*u-s*d-c*f,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,n,r){return this._x=e,this._y=t,this._z=n,this._w=r,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){let n=e._x,r=e._y,i=e._z,a=e._order,o=Math.cos,s=Math.sin,c=o(n/2),l=o(r/2),u=o(i/2),d=s(n/2),f=s(r/2),p=s(i/2);switch(a){case`XYZ`:this._x=d*l*u+c*f*p,this._y=c*f*u-d*l*p,this._z=c*l*p+d*f*u,this._w=c*l*u-d*f*p;break;case`YXZ`:this._x=d*l*u+c*f*p,this._y=c*f*u-d*l*p,this._z=c*l*p-d*f*u,this._w=c*l*u+d*f*p;break;case`ZXY`:this._x=d*l*u-c*f*p,this._y=c*f*u+d*l*p,this._z=c*l*p+d*f*u,this._w=c*l*u-d*f*p;break;case`ZYX`:this._x=d*l*u-c*f*p,this._y=c*f*u+d*l*p,this._z=c*l*p-d*f*u,this._w=c*l*u+d*f*p;break;case`YZX`:this._x=d*l*u+c*f*p,this._y=c*f*u+d*l*p,this._z=c*l*p-d*f*u,this._w=c*l*u-d*f*p;break;case`XZY`:this._x=d*l*u-c*f*p,this._y=c*f*u-d*l*p,this._z=c*l*p+d*f*u,this._w=c*l*u+d*f*p;break;default:W(`Quaternion: .setFromEuler() encountered an unknown order: `+a)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){let n=t/2,r=Math.sin(n);return this._x=e.x*r,this._y=e.y*r,this._z=e.z*r,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(e){let t=e.elements,n=t[0],r=t[4],i=t[8],a=t[1],o=t[5],s=t[9],c=t[2],l=t[6],u=t[10],d=n+o+u;if(d>0){let e=.5/Math.sqrt(d+1);this._w=.25/e,this._x=(l-s)*e,this._y=(i-c)*e,this._z=(a-r)*e}else if(n>o&&n>u){let e=2*Math.sqrt(1+n-o-u);this._w=(l-s)/e,this._x=.25*e,this._y=(r+a)/e,this._z=(i+c)/e}else if(o>u){let e=2*Math.sqrt(1+o-n-u);this._w=(i-c)/e,this._x=(r+a)/e,this._y=.25*e,this._z=(s+l)/e}else{let e=2*Math.sqrt(1+u-n-o);this._w=(a-r)/e,this._x=(i+c)/e,this._y=(s+l)/e,this._z=.25*e}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let n=e.dot(t)+1;return n<1e-8?(n=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=n):(this._x=0,this._y=-e.z,this._z=e.y,this._w=n)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=n),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(K(this.dot(e),-1,1)))}rotateTowards(e,t){let n=this.angleTo(e);if(n===0)return this;let r=Math.min(1,t/n);return this.slerp(e,r),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x*=e,this._y*=e,this._z*=e,this._w*=e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){let n=e._x,r=e._y,i=e._z,a=e._w,o=t._x,s=t._y,c=t._z,l=t._w;return this._x=n*l+a*o+r*c-i*s,this._y=r*l+a*s+i*o-n*c,this._z=i*l+a*c+n*s-r*o,this._w=a*l-n*o-r*s-i*c,this._onChangeCallback(),this}slerp(e,t){let n=e._x,r=e._y,i=e._z,a=e._w,o=this.dot(e);o<0&&(n=-n,r=-r,i=-i,a=-a,o=-o);let s=1-t;if(o<.9995){let e=Math.acos(o),c=Math.sin(e);s=Math.sin(s*e)/c,t=Math.sin(t*e)/c,this._x=this._x*s+n*t,this._y=this._y*s+r*t,this._z=this._z*s+i*t,this._w=this._w*s+a*t,this._onChangeCallback()}else this._x=this._x*s+n*t,this._y=this._y*s+r*t,this._z=this._z*s+i*t,this._w=this._w*s+a*t,this.normalize();return this}slerpQuaternions(e,t,n){return this.copy(e).slerp(t,n)}random(){let e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),n=Math.random(),r=Math.sqrt(1-n),i=Math.sqrt(n);return this.set(r*Math.sin(e),r*Math.cos(e),i*Math.sin(t),i*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},J=class{static{this.prototype.isVector3=!0}constructor(e=0,t=0,n=0){this.x=e,this.y=t,this.z=n}set(e,t,n){return n===void 0&&(n=this.z),this.x=e,this.y=t,this.z=n,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw Error(`THREE.Vector3: index is out of range: `+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw Error(`THREE.Vector3: index is out of range: `+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(yr.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(yr.setFromAxisAngle(e,t))}applyMatrix3(e){let t=this.x,n=this.y,r=this.z,i=e.elements;return this.x=i[0]*t+i[3]*n+i[6]*r,this.y=i[1]*t+i[4]*n+i[7]*r,this.z=i[2]*t+i[5]*n+i[8]*r,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){let t=this.x,n=this.y,r=this.z,i=e.elements,a=1/(i[3]*t+i[7]*n+i[11]*r+i[15]);return this.x=(i[0]*t+i[4]*n+i[8]*r+i[12])*a,this.y=(i[1]*t+i[5]*n+i[9]*r+i[13])*a,this.z=(i[2]*t+i[6]*n+i[10]*r+i[14])*a,this}applyQuaternion(e){let t=this.x,n=this.y,r=this.z,i=e.x,a=e.y,o=e.z,s=e.w,c=2*(a*r-o*n),l=2*(o*t-i*r),u=2*(i*n-a*t);return this.x=t+s*c+a*u-o*l,this.y=n+s*l+o*c-i*u,this.z=r+s*u+i*l-a*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){let t=this.x,n=this.y,r=this.z,i=e.elements;return this.x=i[0]*t+i[4]*n+i[8]*r,this.y=i[1]*t+i[5]*n+i[9]*r,this.z=i[2]*t+i[6]*n+i[10]*r,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=K(this.x,e.x,t.x),this.y=K(this.y,e.y,t.y),this.z=K(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=K(this.x,e,t),this.y=K(this.y,e,t),this.z=K(this.z,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(K(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){let n=e.x,r=e.y,i=e.z,a=t.x,o=t.y,s=t.z;return this.x=r*s-i*o,this.y=i*a-n*s,this.z=n*o-r*a,this}projectOnVector(e){let t=e.lengthSq();if(t===0)return this.set(0,0,0);let n=e.dot(this)/t;return this.copy(e).multiplyScalar(n)}projectOnPlane(e){return vr.copy(this).projectOnVector(e),this.sub(vr)}reflect(e){return this.sub(vr.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(K(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y,r=this.z-e.z;return t*t+n*n+r*r}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,n){let r=Math.sin(t)*e;return this.x=r*Math.sin(n),this.y=Math.cos(t)*e,this.z=r*Math.cos(n),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,n){return this.x=e*Math.sin(t),this.y=n,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){let t=this.setFromMatrixColumn(e,0).length(),n=this.setFromMatrixColumn(e,1).length(),r=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=n,this.z=r,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let e=Math.random()*Math.PI*2,t=Math.random()*2-1,n=Math.sqrt(1-t*t);return this.x=n*Math.cos(e),this.y=t,this.z=n*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},vr=new J,yr=new _r,Y=class{static{this.prototype.isMatrix3=!0}constructor(e,t,n,r,i,a,o,s,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,n,r,i,a,o,s,c)}set(e,t,n,r,i,a,o,s,c){let l=this.elements;return l[0]=e,l[1]=r,l[2]=o,l[3]=t,l[4]=i,l[5]=s,l[6]=n,l[7]=a,l[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],this}extractBasis(e,t,n){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(e){let t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,r=t.elements,i=this.elements,a=n[0],o=n[3],s=n[6],c=n[1],l=n[4],u=n[7],d=n[2],f=n[5],p=n[8],m=r[0],h=r[3],g=r[6],_=r[1],v=r[4],y=r[7],b=r[2],x=r[5],S=r[8];return i[0]=a*m+o*_+s*b,i[3]=a*h+o*v+s*x,i[6]=a*g+o*y+s*S,i[1]=c*m+l*_+u*b,i[4]=c*h+l*v+u*x,i[7]=c*g+l*y+u*S,i[2]=d*m+f*_+p*b,i[5]=d*h+f*v+p*x,i[8]=d*g+f*y+p*S,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[1],r=e[2],i=e[3],a=e[4],o=e[5],s=e[6],c=e[7],l=e[8];return t*a*l-t*o*c-n*i*l+n*o*s+r*i*c-r*a*s}invert(){let e=this.elements,t=e[0],n=e[1],r=e[2],i=e[3],a=e[4],o=e[5],s=e[6],c=e[7],l=e[8],u=l*a-o*c,d=o*s-l*i,f=c*i-a*s,p=t*u+n*d+r*f;if(p===0)return this.set(0,0,0,0,0,0,0,0,0);let m=1/p;return e[0]=u*m,e[1]=(r*c-l*n)*m,e[2]=(o*n-r*a)*m,e[3]=d*m,e[4]=(l*t-r*s)*m,e[5]=(r*i-o*t)*m,e[6]=f*m,e[7]=(n*s-c*t)*m,e[8]=(a*t-n*i)*m,this}transpose(){let e,t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){let t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,n,r,i,a,o){let s=Math.cos(i),c=Math.sin(i);return this.set(n*s,n*c,-n*(s*a+c*o)+a+e,-r*c,r*s,-r*(-c*a+s*o)+o+t,0,0,1),this}scale(e,t){return rr(`Matrix3: .scale() is deprecated. Use .makeScale() instead.`),this.premultiply(br.makeScale(e,t)),this}rotate(e){return rr(`Matrix3: .rotate() is deprecated. Use .makeRotation() instead.`),this.premultiply(br.makeRotation(-e)),this}translate(e,t){return rr(`Matrix3: .translate() is deprecated. Use .makeTranslation() instead.`),this.premultiply(br.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,n,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){let t=this.elements,n=e.elements;for(let e=0;e<9;e++)if(t[e]!==n[e])return!1;return!0}fromArray(e,t=0){for(let n=0;n<9;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e}clone(){return new this.constructor().fromArray(this.elements)}},br=new Y,xr=new Y().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),Sr=new Y().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function Cr(){let e={enabled:!0,workingColorSpace:Un,spaces:{},convert:function(e,t,n){return this.enabled===!1||t===n||!t||!n||(this.spaces[t].transfer===`srgb`&&(e.r=wr(e.r),e.g=wr(e.g),e.b=wr(e.b)),this.spaces[t].primaries!==this.spaces[n].primaries&&(e.applyMatrix3(this.spaces[t].toXYZ),e.applyMatrix3(this.spaces[n].fromXYZ)),this.spaces[n].transfer===`srgb`&&(e.r=Tr(e.r),e.g=Tr(e.g),e.b=Tr(e.b))),e},workingToColorSpace:function(e,t){return this.convert(e,this.workingColorSpace,t)},colorSpaceToWorking:function(e,t){return this.convert(e,t,this.workingColorSpace)},getPrimaries:function(e){return this.spaces[e].primaries},getTransfer:function(e){return e===``?Wn:this.spaces[e].transfer},getToneMappingMode:function(e){return this.spaces[e].outputColorSpaceConfig.toneMappingMode||`standard`},getLuminanceCoefficients:function(e,t=this.workingColorSpace){return e.fromArray(this.spaces[t].luminanceCoefficients)},define:function(e){Object.assign(this.spaces,e)},_getMatrix:function(e,t,n){return e.copy(this.spaces[n].fromXYZ).multiply(this.spaces[t].toXYZ)},_getDrawingBufferColorSpace:function(e){return this.spaces[e].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(e=this.workingColorSpace){return this.spaces[e].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],n=[.2126,.7152,.0722],r=[.3127,.329];return e.define({[Un]:{primaries:t,whitePoint:r,transfer:Wn,toXYZ:xr,fromXYZ:Sr,luminanceCoefficients:n,workingColorSpaceConfig:{unpackColorSpace:Hn},outputColorSpaceConfig:{drawingBufferColorSpace:Hn}},[Hn]:{primaries:t,whitePoint:r,transfer:Gn,toXYZ:xr,fromXYZ:Sr,luminanceCoefficients:n,outputColorSpaceConfig:{drawingBufferColorSpace:Hn}}}),e}var X=Cr();function wr(e){return e<.04045?e*.0773993808:(e*.9478672986+.0521327014)**2.4}function Tr(e){return e<.0031308?e*12.92:1.055*e**.41666-.055}var Er,Dr=class{static getDataURL(e,t=`image/png`){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>`u`)return e.src;let n;if(e instanceof HTMLCanvasElement)n=e;else{Er===void 0&&(Er=Qn(`canvas`)),Er.width=e.width,Er.height=e.height;let t=Er.getContext(`2d`);e instanceof ImageData?t.putImageData(e,0,0):t.drawImage(e,0,0,e.width,e.height),n=Er}return n.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<`u`&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<`u`&&e instanceof HTMLCanvasElement||typeof ImageBitmap<`u`&&e instanceof ImageBitmap){let t=Qn(`canvas`);t.width=e.width,t.height=e.height;let n=t.getContext(`2d`);n.drawImage(e,0,0,e.width,e.height);let r=n.getImageData(0,0,e.width,e.height),i=r.data;for(let e=0;e<i.length;e++)i[e]=wr(i[e]/255)*255;return n.putImageData(r,0,0),t}if(e.data){let t=e.data.slice(0);for(let e=0;e<t.length;e++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[e]=Math.floor(wr(t[e]/255)*255):t[e]=wr(t[e]);return{data:t,width:e.width,height:e.height}}return W(`ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied.`),e}},Or=0,kr=class{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:Or++}),this.uuid=ur(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){let t=this.data;return typeof HTMLVideoElement<`u`&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<`u`&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t===null?e.set(0,0,0):e.set(t.width||0,t.height||0,t.depth||0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){let t=e===void 0||typeof e==`string`;if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];let n={uuid:this.uuid,url:``},r=this.data;if(r!==null){let e;if(Array.isArray(r)){e=[];for(let t=0,n=r.length;t<n;t++)r[t].isDataTexture?e.push(Ar(r[t].image)):e.push(Ar(r[t]))}else e=Ar(r);n.url=e}return t||(e.images[this.uuid]=n),n}};function Ar(e){return typeof HTMLImageElement<`u`&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<`u`&&e instanceof HTMLCanvasElement||typeof ImageBitmap<`u`&&e instanceof ImageBitmap?Dr.getDataURL(e):e.data?{data:Array.from(e.data),width:e.width,height:e.height,type:e.data.constructor.name}:(W(`Texture: Unable to serialize Texture.`),{})}var jr=0,Mr=new J,Nr=class e extends or{constructor(t=e.DEFAULT_IMAGE,n=e.DEFAULT_MAPPING,r=bt,i=bt,a=Tt,o=Dt,s=Ut,c=Ot,l=e.DEFAULT_ANISOTROPY,u=``){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:jr++}),this.uuid=ur(),this.name=``,this.source=new kr(t),this.mipmaps=[],this.mapping=n,this.channel=0,this.wrapS=r,this.wrapT=i,this.magFilter=a,this.minFilter=o,this.anisotropy=l,this.format=s,this.internalFormat=null,this.type=c,this.offset=new q(0,0),this.repeat=new q(1,1),this.center=new q(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new Y,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=u,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Mr).x}get height(){return this.source.getSize(Mr).y}get depth(){return this.source.getSize(Mr).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(let t in e){let n=e[t];if(n===void 0){W(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}let r=this[t];r===void 0?W(`Texture.setValues(): property '${t}' does not exist.`):r&&n&&r.isVector2&&n.isVector2||r&&n&&r.isVector3&&n.isVector3||r&&n&&r.isMatrix3&&n.isMatrix3?r.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e==`string`;if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];let n={metadata:{version:4.7,type:`Texture`,generator:`Texture.toJSON`},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),t||(e.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:`dispose`})}transformUv(e){if(this.mapping!==300)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case yt:e.x-=Math.floor(e.x);break;case bt:e.x=e.x<0?0:1;break;case xt:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x-=Math.floor(e.x)}if(e.y<0||e.y>1)switch(this.wrapT){case yt:e.y-=Math.floor(e.y);break;case bt:e.y=e.y<0?0:1;break;case xt:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y-=Math.floor(e.y)}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}};Nr.DEFAULT_IMAGE=null,Nr.DEFAULT_MAPPING=300,Nr.DEFAULT_ANISOTROPY=1;var Pr=class{static{this.prototype.isVector4=!0}constructor(e=0,t=0,n=0,r=1){this.x=e,this.y=t,this.z=n,this.w=r}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,n,r){return this.x=e,this.y=t,this.z=n,this.w=r,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw Error(`THREE.Vector4: index is out of range: `+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw Error(`THREE.Vector4: index is out of range: `+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w===void 0?1:e.w,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){let t=this.x,n=this.y,r=this.z,i=this.w,a=e.elements;return this.x=a[0]*t+a[4]*n+a[8]*r+a[12]*i,this.y=a[1]*t+a[5]*n+a[9]*r+a[13]*i,this.z=a[2]*t+a[6]*n+a[10]*r+a[14]*i,this.w=a[3]*t+a[7]*n+a[11]*r+a[15]*i,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);let t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,n,r,i,a=.01,o=.1,s=e.elements,c=s[0],l=s[4],u=s[8],d=s[1],f=s[5],p=s[9],m=s[2],h=s[6],g=s[10];if(Math.abs(l-d)<a&&Math.abs(u-m)<a&&Math.abs(p-h)<a){if(Math.abs(l+d)<o&&Math.abs(u+m)<o&&Math.abs(p+h)<o&&Math.abs(c+f+g-3)<o)return this.set(1,0,0,0),this;t=Math.PI;let e=(c+1)/2,s=(f+1)/2,_=(g+1)/2,v=(l+d)/4,y=(u+m)/4,b=(p+h)/4;return e>s&&e>_?e<a?(n=0,r=.707106781,i=.707106781):(n=Math.sqrt(e),r=v/n,i=y/n):s>_?s<a?(n=.707106781,r=0,i=.707106781):(r=Math.sqrt(s),n=v/r,i=b/r):_<a?(n=.707106781,r=.707106781,i=0):(i=Math.sqrt(_),n=y/i,r=b/i),this.set(n,r,i,t),this}let _=Math.sqrt((h-p)*(h-p)+(u-m)*(u-m)+(d-l)*(d-l));return Math.abs(_)<.001&&(_=1),this.x=(h-p)/_,this.y=(u-m)/_,this.z=(d-l)/_,this.w=Math.acos((c+f+g-1)/2),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=K(this.x,e.x,t.x),this.y=K(this.y,e.y,t.y),this.z=K(this.z,e.z,t.z),this.w=K(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=K(this.x,e,t),this.y=K(this.y,e,t),this.z=K(this.z,e,t),this.w=K(this.w,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(K(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this.w=e.w+(t.w-e.w)*n,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Fr=class extends or{constructor(e=1,t=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:Tt,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=e,this.height=t,this.depth=n.depth,this.scissor=new Pr(0,0,e,t),this.scissorTest=!1,this.viewport=new Pr(0,0,e,t),this.textures=[];let r=n.count;for(let i=0;i<r;i++)this.textures[i]=new Nr({width:e,height:t,depth:n.depth}),this.textures[i].isRenderTargetTexture=!0,this.textures[i].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(e={}){let t={minFilter:Tt,generateMipmaps:!1,flipY:!1,internalFormat:null};e.mapping!==void 0&&(t.mapping=e.mapping),e.wrapS!==void 0&&(t.wrapS=e.wrapS),e.wrapT!==void 0&&(t.wrapT=e.wrapT),e.wrapR!==void 0&&(t.wrapR=e.wrapR),e.magFilter!==void 0&&(t.magFilter=e.magFilter),e.minFilter!==void 0&&(t.minFilter=e.minFilter),e.format!==void 0&&(t.format=e.format),e.type!==void 0&&(t.type=e.type),e.anisotropy!==void 0&&(t.anisotropy=e.anisotropy),e.colorSpace!==void 0&&(t.colorSpace=e.colorSpace),e.flipY!==void 0&&(t.flipY=e.flipY),e.generateMipmaps!==void 0&&(t.generateMipmaps=e.generateMipmaps),e.mipmapsAutoUpdate!==void 0&&(t.mipmapsAutoUpdate=e.mipmapsAutoUpdate),e.internalFormat!==void 0&&(t.internalFormat=e.internalFormat);for(let e=0;e<this.textures.length;e++)this.textures[e].setValues(t)}get texture(){return this.textures[0]}set texture(e){this.textures[0]=e}set depthTexture(e){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),e!==null&&e.renderTarget===null&&(e.renderTarget=this),this._depthTexture=e}get depthTexture(){return this._depthTexture}setSize(e,t,n=1){if(this.width!==e||this.height!==t||this.depth!==n){this.width=e,this.height=t,this.depth=n;for(let r=0,i=this.textures.length;r<i;r++)this.textures[r].image.width=e,this.textures[r].image.height=t,this.textures[r].image.depth=n,this.textures[r].isData3DTexture!==!0&&(this.textures[r].isArrayTexture=this.textures[r].image.depth>1);this.dispose()}this.viewport.set(0,0,e,t),this.scissor.set(0,0,e,t)}clone(){return new this.constructor().copy(this)}copy(e){this.width=e.width,this.height=e.height,this.depth=e.depth,this.scissor.copy(e.scissor),this.scissorTest=e.scissorTest,this.viewport.copy(e.viewport),this.textures.length=0;for(let t=0,n=e.textures.length;t<n;t++){this.textures[t]=e.textures[t].clone(),this.textures[t].isRenderTargetTexture=!0,this.textures[t].renderTarget=this;let n=Object.assign({},e.textures[t].image);this.textures[t].source=new kr(n)}if(this.depthBuffer=e.depthBuffer,this.stencilBuffer=e.stencilBuffer,this.resolveColorBuffer=e.resolveColorBuffer,this.resolveDepthBuffer=e.resolveDepthBuffer,this.resolveStencilBuffer=e.resolveStencilBuffer,this.storeMultisampledColorBuffer=e.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=e.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=e.storeMultisampledStencilBuffer,e.depthTexture!==null){if(e.depthTexture.renderTarget===e){let t=e.depthTexture.clone();t.renderTarget=null,this.depthTexture=t}else this.depthTexture=e.depthTexture}else this.depthTexture=null;return this.samples=e.samples,this.multiview=e.multiview,this.useArrayDepthTexture=e.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:`dispose`})}},Ir=class extends Fr{constructor(e=1,t=1,n={}){super(e,t,n),this.isWebGLRenderTarget=!0}},Lr=class extends Nr{constructor(e=null,t=1,n=1,r=1){super(null),this.isDataArrayTexture=!0,this.image={data:e,width:t,height:n,depth:r},this.magFilter=St,this.minFilter=St,this.wrapR=bt,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}addLayerUpdate(e){this.layerUpdates.add(e)}clearLayerUpdates(){this.layerUpdates.clear()}},Rr=class extends Nr{constructor(e=null,t=1,n=1,r=1){super(null),this.isData3DTexture=!0,this.image={data:e,width:t,height:n,depth:r},this.magFilter=St,this.minFilter=St,this.wrapR=bt,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}},zr=class e{static{this.prototype.isMatrix4=!0}constructor(e,t,n,r,i,a,o,s,c,l,u,d,f,p,m,h){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,n,r,i,a,o,s,c,l,u,d,f,p,m,h)}set(e,t,n,r,i,a,o,s,c,l,u,d,f,p,m,h){let g=this.elements;return g[0]=e,g[4]=t,g[8]=n,g[12]=r,g[1]=i,g[5]=a,g[9]=o,g[13]=s,g[2]=c,g[6]=l,g[10]=u,g[14]=d,g[3]=f,g[7]=p,g[11]=m,g[15]=h,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new e().fromArray(this.elements)}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],t[9]=n[9],t[10]=n[10],t[11]=n[11],t[12]=n[12],t[13]=n[13],t[14]=n[14],t[15]=n[15],this}copyPosition(e){let t=this.elements,n=e.elements;return t[12]=n[12],t[13]=n[13],t[14]=n[14],this}setFromMatrix3(e){let t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,n){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),n.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(e,t,n){return this.set(e.x,t.x,n.x,0,e.y,t.y,n.y,0,e.z,t.z,n.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();let t=this.elements,n=e.elements,r=1/Br.setFromMatrixColumn(e,0).length(),i=1/Br.setFromMatrixColumn(e,1).length(),a=1/Br.setFromMatrixColumn(e,2).length();return t[0]=n[0]*r,t[1]=n[1]*r,t[2]=n[2]*r,t[3]=0,t[4]=n[4]*i,t[5]=n[5]*i,t[6]=n[6]*i,t[7]=0,t[8]=n[8]*a,t[9]=n[9]*a,t[10]=n[10]*a,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){let t=this.elements,n=e.x,r=e.y,i=e.z,a=Math.cos(n),o=Math.sin(n),s=Math.cos(r),c=Math.sin(r),l=Math.cos(i),u=Math.sin(i);if(e.order===`XYZ`){let e=a*l,n=a*u,r=o*l,i=o*u;t[0]=s*l,t[4]=-s*u,t[8]=c,t[1]=n+r*c,t[5]=e-i*c,t[9]=-o*s,t[2]=i-e*c,t[6]=r+n*c,t[10]=a*s}else if(e.order===`YXZ`){let e=s*l,n=s*u,r=c*l,i=c*u;t[0]=e+i*o,t[4]=r*o-n,t[8]=a*c,t[1]=a*u,t[5]=a*l,t[9]=-o,t[2]=n*o-r,t[6]=i+e*o,t[10]=a*s}else if(e.order===`ZXY`){let e=s*l,n=s*u,r=c*l,i=c*u;t[0]=e-i*o,t[4]=-a*u,t[8]=r+n*o,t[1]=n+r*o,t[5]=a*l,t[9]=i-e*o,t[2]=-a*c,t[6]=o,t[10]=a*s}else if(e.order===`ZYX`){let e=a*l,n=a*u,r=o*l,i=o*u;t[0]=s*l,t[4]=r*c-n,t[8]=e*c+i,t[1]=s*u,t[5]=i*c+e,t[9]=n*c-r,t[2]=-c,t[6]=o*s,t[10]=a*s}else if(e.order===`YZX`){let e=a*s,n=a*c,r=o*s,i=o*c;t[0]=s*l,t[4]=i-e*u,t[8]=r*u+n,t[1]=u,t[5]=a*l,t[9]=-o*l,t[2]=-c*l,t[6]=n*u+r,t[10]=e-i*u}else if(e.order===`XZY`){let e=a*s,n=a*c,r=o*s,i=o*c;t[0]=s*l,t[4]=-u,t[8]=c*l,t[1]=e*u+i,t[5]=a*l,t[9]=n*u-r,t[2]=r*u-n,t[6]=o*l,t[10]=i*u+e}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(Hr,e,Ur)}lookAt(e,t,n){let r=this.elements;return Kr.subVectors(e,t),Kr.lengthSq()===0&&(Kr.z=1),Kr.normalize(),Wr.crossVectors(n,Kr),Wr.lengthSq()===0&&(Math.abs(n.z)===1?Kr.x+=1e-4:Kr.z+=1e-4,Kr.normalize(),Wr.crossVectors(n,Kr)),Wr.normalize(),Gr.crossVectors(Kr,Wr),r[0]=Wr.x,r[4]=Gr.x,r[8]=Kr.x,r[1]=Wr.y,r[5]=Gr.y,r[9]=Kr.y,r[2]=Wr.z,r[6]=Gr.z,r[10]=Kr.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,r=t.elements,i=this.elements,a=n[0],o=n[4],s=n[8],c=n[12],l=n[1],u=n[5],d=n[9],f=n[13],p=n[2],m=n[6],h=n[10],g=n[14],_=n[3],v=n[7],y=n[11],b=n[15],x=r[0],S=r[4],C=r[8],w=r[12],T=r[1],E=r[5],D=r[9],O=r[13],k=r[2],A=r[6],j=r[10],M=r[14],N=r[3],P=r[7],F=r[11],I=r[15];return i[0]=a*x+o*T+s*k+c*N,i[4]=a*S+o*E+s*A+c*P,i[8]=a*C+o*D+s*j+c*F,i[12]=a*w+o*O+s*M+c*I,i[1]=l*x+u*T+d*k+f*N,i[5]=l*S+u*E+d*A+f*P,i[9]=l*C+u*D+d*j+f*F,i[13]=l*w+u*O+d*M+f*I,i[2]=p*x+m*T+h*k+g*N,i[6]=p*S+m*E+h*A+g*P,i[10]=p*C+m*D+h*j+g*F,i[14]=p*w+m*O+h*M+g*I,i[3]=_*x+v*T+y*k+b*N,i[7]=_*S+v*E+y*A+b*P,i[11]=_*C+v*D+y*j+b*F,i[15]=_*w+v*O+y*M+b*I,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[4],r=e[8],i=e[12],a=e[1],o=e[5],s=e[9],c=e[13],l=e[2],u=e[6],d=e[10],f=e[14],p=e[3],m=e[7],h=e[11],g=e[15],_=s*f-c*d,v=o*f-c*u,y=o*d-s*u,b=a*f-c*l,x=a*d-s*l,S=a*u-o*l;return t*(m*_-h*v+g*y)-n*(p*_-h*b+g*x)+r*(p*v-m*b+g*S)-i*(p*y-m*x+h*S)}determinantAffine(){let e=this.elements,t=e[0],n=e[4],r=e[8],i=e[1],a=e[5],o=e[9],s=e[2],c=e[6],l=e[10];return t*(a*l-o*c)-n*(i*l-o*s)+r*(i*c-a*s)}transpose(){let e=this.elements,t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,n){let r=this.elements;return e.isVector3?(r[12]=e.x,r[13]=e.y,r[14]=e.z):(r[12]=e,r[13]=t,r[14]=n),this}invert(){let e=this.elements,t=e[0],n=e[1],r=e[2],i=e[3],a=e[4],o=e[5],s=e[6],c=e[7],l=e[8],u=e[9],d=e[10],f=e[11],p=e[12],m=e[13],h=e[14],g=e[15],_=t*o-n*a,v=t*s-r*a,y=t*c-i*a,b=n*s-r*o,x=n*c-i*o,S=r*c-i*s,C=l*m-u*p,w=l*h-d*p,T=l*g-f*p,E=u*h-d*m,D=u*g-f*m,O=d*g-f*h,k=_*O-v*D+y*E+b*T-x*w+S*C;if(k===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let A=1/k;return e[0]=(o*O-s*D+c*E)*A,e[1]=(r*D-n*O-i*E)*A,e[2]=(m*S-h*x+g*b)*A,e[3]=(d*x-u*S-f*b)*A,e[4]=(s*T-a*O-c*w)*A,e[5]=(t*O-r*T+i*w)*A,e[6]=(h*y-p*S-g*v)*A,e[7]=(l*S-d*y+f*v)*A,e[8]=(a*D-o*T+c*C)*A,e[9]=(n*T-t*D-i*C)*A,e[10]=(p*x-m*y+g*_)*A,e[11]=(u*y-l*x-f*_)*A,e[12]=(o*w-a*E-s*C)*A,e[13]=(t*E-n*w+r*C)*A,e[14]=(m*v-p*b-h*_)*A,e[15]=(l*b-u*v+d*_)*A,this}scale(e){let t=this.elements,n=e.x,r=e.y,i=e.z;return t[0]*=n,t[4]*=r,t[8]*=i,t[1]*=n,t[5]*=r,t[9]*=i,t[2]*=n,t[6]*=r,t[10]*=i,t[3]*=n,t[7]*=r,t[11]*=i,this}getMaxScaleOnAxis(){let e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],n=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],r=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,n,r))}makeTranslation(e,t,n){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,n,0,0,0,1),this}makeRotationX(e){let t=Math.cos(e),n=Math.sin(e);return this.set(1,0,0,0,0,t,-n,0,0,n,t,0,0,0,0,1),this}makeRotationY(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,0,n,0,0,1,0,0,-n,0,t,0,0,0,0,1),this}makeRotationZ(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,0,n,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){let n=Math.cos(t),r=Math.sin(t),i=1-n,a=e.x,o=e.y,s=e.z,c=i*a,l=i*o;return this.set(c*a+n,c*o-r*s,c*s+r*o,0,c*o+r*s,l*o+n,l*s-r*a,0,c*s-r*o,l*s+r*a,i*s*s+n,0,0,0,0,1),this}makeScale(e,t,n){return this.set(e,0,0,0,0,t,0,0,0,0,n,0,0,0,0,1),this}makeShear(e,t,n,r,i,a){return this.set(1,n,i,0,e,1,a,0,t,r,1,0,0,0,0,1),this}compose(e,t,n){let r=this.elements,i=t._x,a=t._y,o=t._z,s=t._w,c=i+i,l=a+a,u=o+o,d=i*c,f=i*l,p=i*u,m=a*l,h=a*u,g=o*u,_=s*c,v=s*l,y=s*u,b=n.x,x=n.y,S=n.z;return r[0]=(1-(m+g))*b,r[1]=(f+y)*b,r[2]=(p-v)*b,r[3]=0,r[4]=(f-y)*x,r[5]=(1-(d+g))*x,r[6]=(h+_)*x,r[7]=0,r[8]=(p+v)*S,r[9]=(h-_)*S,r[10]=(1-(d+m))*S,r[11]=0,r[12]=e.x,r[13]=e.y,r[14]=e.z,r[15]=1,this}decompose(e,t,n){let r=this.elements;e.x=r[12],e.y=r[13],e.z=r[14];let i=this.determinantAffine();if(i===0)return n.set(1,1,1),t.identity(),this;let a=Br.set(r[0],r[1],r[2]).length(),o=Br.set(r[4],r[5],r[6]).length(),s=Br.set(r[8],r[9],r[10]).length();i<0&&(a=-a),Vr.copy(this);let c=1/a,l=1/o,u=1/s;return Vr.elements[0]*=c,Vr.elements[1]*=c,Vr.elements[2]*=c,Vr.elements[4]*=l,Vr.elements[5]*=l,Vr.elements[6]*=l,Vr.elements[8]*=u,Vr.elements[9]*=u,Vr.elements[10]*=u,t.setFromRotationMatrix(Vr),n.x=a,n.y=o,n.z=s,this}makePerspective(e,t,n,r,i,a,o=Yn,s=!1){let c=this.elements,l=2*i/(t-e),u=2*i/(n-r),d=(t+e)/(t-e),f=(n+r)/(n-r),p,m;if(s)p=i/(a-i),m=a*i/(a-i);else if(o===2e3)p=-(a+i)/(a-i),m=-2*a*i/(a-i);else if(o===2001)p=-a/(a-i),m=-a*i/(a-i);else throw Error(`THREE.Matrix4.makePerspective(): Invalid coordinate system: `+o);return c[0]=l,c[4]=0,c[8]=d,c[12]=0,c[1]=0,c[5]=u,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=p,c[14]=m,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,n,r,i,a,o=Yn,s=!1){let c=this.elements,l=2/(t-e),u=2/(n-r),d=-(t+e)/(t-e),f=-(n+r)/(n-r),p,m;if(s)p=1/(a-i),m=a/(a-i);else if(o===2e3)p=-2/(a-i),m=-(a+i)/(a-i);else if(o===2001)p=-1/(a-i),m=-i/(a-i);else throw Error(`THREE.Matrix4.makeOrthographic(): Invalid coordinate system: `+o);return c[0]=l,c[4]=0,c[8]=0,c[12]=d,c[1]=0,c[5]=u,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=p,c[14]=m,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){let t=this.elements,n=e.elements;for(let e=0;e<16;e++)if(t[e]!==n[e])return!1;return!0}fromArray(e,t=0){for(let n=0;n<16;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e[t+9]=n[9],e[t+10]=n[10],e[t+11]=n[11],e[t+12]=n[12],e[t+13]=n[13],e[t+14]=n[14],e[t+15]=n[15],e}},Br=new J,Vr=new zr,Hr=new J(0,0,0),Ur=new J(1,1,1),Wr=new J,Gr=new J,Kr=new J,qr=new zr,Jr=new _r,Yr=class e{constructor(t=0,n=0,r=0,i=e.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=n,this._z=r,this._order=i}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,n,r=this._order){return this._x=e,this._y=t,this._z=n,this._order=r,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,n=!0){let r=e.elements,i=r[0],a=r[4],o=r[8],s=r[1],c=r[5],l=r[9],u=r[2],d=r[6],f=r[10];switch(t){case`XYZ`:this._y=Math.asin(K(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(-l,f),this._z=Math.atan2(-a,i)):(this._x=Math.atan2(d,c),this._z=0);break;case`YXZ`:this._x=Math.asin(-K(l,-1,1)),Math.abs(l)<.9999999?(this._y=Math.atan2(o,f),this._z=Math.atan2(s,c)):(this._y=Math.atan2(-u,i),this._z=0);break;case`ZXY`:this._x=Math.asin(K(d,-1,1)),Math.abs(d)<.9999999?(this._y=Math.atan2(-u,f),this._z=Math.atan2(-a,c)):(this._y=0,this._z=Math.atan2(s,i));break;case`ZYX`:this._y=Math.asin(-K(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(d,f),this._z=Math.atan2(s,i)):(this._x=0,this._z=Math.atan2(-a,c));break;case`YZX`:this._z=Math.asin(K(s,-1,1)),Math.abs(s)<.9999999?(this._x=Math.atan2(-l,c),this._y=Math.atan2(-u,i)):(this._x=0,this._y=Math.atan2(o,f));break;case`XZY`:this._z=Math.asin(-K(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(d,c),this._y=Math.atan2(o,i)):(this._x=Math.atan2(-l,f),this._y=0);break;default:W(`Euler: .setFromRotationMatrix() encountered an unknown order: `+t)}return this._order=t,n===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,n){return qr.makeRotationFromQuaternion(e),this.setFromRotationMatrix(qr,t,n)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return Jr.setFromEuler(this),this.setFromQuaternion(Jr,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};Yr.DEFAULT_ORDER=`XYZ`;var Xr=class{constructor(){this.mask=1}set(e){this.mask=1<<e>>>0}enable(e){this.mask|=1<<e}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e}disable(e){this.mask&=~(1<<e)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return!!(this.mask&1<<e)}},Zr=0,Qr=new J,$r=new _r,ei=new zr,ti=new J,ni=new J,ri=new J,ii=new _r,ai=new J(1,0,0),oi=new J(0,1,0),si=new J(0,0,1),ci={type:`added`},li={type:`removed`},ui={type:`childadded`,child:null},di={type:`childremoved`,child:null},fi=class e extends or{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Zr++}),this.uuid=ur(),this.name=``,this.type=`Object3D`,this.parent=null,this.children=[],this.up=e.DEFAULT_UP.clone();let t=new J,n=new Yr,r=new _r,i=new J(1,1,1);function a(){r.setFromEuler(n,!1)}function o(){n.setFromQuaternion(r,void 0,!1)}n._onChange(a),r._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:n},quaternion:{configurable:!0,enumerable:!0,value:r},scale:{configurable:!0,enumerable:!0,value:i},modelViewMatrix:{value:new zr},normalMatrix:{value:new Y}}),this.matrix=new zr,this.matrixWorld=new zr,this.matrixAutoUpdate=e.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=e.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Xr,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return $r.setFromAxisAngle(e,t),this.quaternion.multiply($r),this}rotateOnWorldAxis(e,t){return $r.setFromAxisAngle(e,t),this.quaternion.premultiply($r),this}rotateX(e){return this.rotateOnAxis(ai,e)}rotateY(e){return this.rotateOnAxis(oi,e)}rotateZ(e){return this.rotateOnAxis(si,e)}translateOnAxis(e,t){return Qr.copy(e).applyQuaternion(this.quaternion),this.position.add(Qr.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(ai,e)}translateY(e){return this.translateOnAxis(oi,e)}translateZ(e){return this.translateOnAxis(si,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(ei.copy(this.matrixWorld).invert())}lookAt(e,t,n){e.isVector3?ti.copy(e):ti.set(e,t,n);let r=this.parent;this.updateWorldMatrix(!0,!1),ni.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?ei.lookAt(ni,ti,this.up):ei.lookAt(ti,ni,this.up),this.quaternion.setFromRotationMatrix(ei),r&&(ei.extractRotation(r.matrixWorld),$r.setFromRotationMatrix(ei),this.quaternion.premultiply($r.invert()))}add(e){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return e===this?(G(`Object3D.add: object can't be added as a child of itself.`,e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(ci),ui.child=e,this.dispatchEvent(ui),ui.child=null):G(`Object3D.add: object not an instance of THREE.Object3D.`,e),this)}remove(e){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.remove(arguments[e]);return this}let t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(li),di.child=e,this.dispatchEvent(di),di.child=null),this}removeFromParent(){let e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),ei.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),ei.multiply(e.parent.matrixWorld)),e.applyMatrix4(ei),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(ci),ui.child=e,this.dispatchEvent(ui),ui.child=null,this}getObjectById(e){return this.getObjectByProperty(`id`,e)}getObjectByName(e){return this.getObjectByProperty(`name`,e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let n=0,r=this.children.length;n<r;n++){let r=this.children[n].getObjectByProperty(e,t);if(r!==void 0)return r}}getObjectsByProperty(e,t,n=[]){this[e]===t&&n.push(this);let r=this.children;for(let i=0,a=r.length;i<a;i++)r[i].getObjectsByProperty(e,t,n);return n}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ni,e,ri),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ni,ii,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);let t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);let t=this.children;for(let n=0,r=t.length;n<r;n++)t[n].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);let t=this.children;for(let n=0,r=t.length;n<r;n++)t[n].traverseVisible(e)}traverseAncestors(e){let t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let e=this.pivot;if(e!==null){let t=e.x,n=e.y,r=e.z,i=this.matrix.elements;i[12]+=t-i[0]*t-i[4]*n-i[8]*r,i[13]+=n-i[1]*t-i[5]*n-i[9]*r,i[14]+=r-i[2]*t-i[6]*n-i[10]*r}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);let t=this.children;for(let n=0,r=t.length;n<r;n++)t[n].updateMatrixWorld(e)}updateWorldMatrix(e,t,n=!1){let r=this.parent;if(e===!0&&r!==null&&r.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),t===!0){let e=this.children;for(let t=0,r=e.length;t<r;t++)e[t].updateWorldMatrix(!1,!0,n)}}toJSON(e){let t=e===void 0||typeof e==`string`,n={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:`Object`,generator:`Object3D.toJSON`});let r={};r.uuid=this.uuid,r.type=this.type,r.name=this.name,r.castShadow=this.castShadow,r.receiveShadow=this.receiveShadow,r.visible=this.visible,r.frustumCulled=this.frustumCulled,r.renderOrder=this.renderOrder,r.static=this.static,r.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(r.userData=this.userData),r.layers=this.layers.mask,r.matrix=this.matrix.toArray(),r.up=this.up.toArray(),this.pivot!==null&&(r.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(r.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(r.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(r.type=`InstancedMesh`,r.count=this.count,r.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(r.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(r.type=`BatchedMesh`,r.perObjectFrustumCulled=this.perObjectFrustumCulled,r.sortObjects=this.sortObjects,r.drawRanges=this._drawRanges,r.reservedRanges=this._reservedRanges,r.geometryInfo=this._geometryInfo.map(e=>({...e,boundingBox:e.boundingBox?e.boundingBox.toJSON():void 0,boundingSphere:e.boundingSphere?e.boundingSphere.toJSON():void 0})),r.instanceInfo=this._instanceInfo.map(e=>({...e})),r.availableInstanceIds=this._availableInstanceIds.slice(),r.availableGeometryIds=this._availableGeometryIds.slice(),r.nextIndexStart=this._nextIndexStart,r.nextVertexStart=this._nextVertexStart,r.geometryCount=this._geometryCount,r.maxInstanceCount=this._maxInstanceCount,r.maxVertexCount=this._maxVertexCount,r.maxIndexCount=this._maxIndexCount,r.geometryInitialized=this._geometryInitialized,r.matricesTexture=this._matricesTexture.toJSON(e),r.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(r.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(r.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(r.boundingBox=this.boundingBox.toJSON()));function i(t,n){return t[n.uuid]===void 0&&(t[n.uuid]=n.toJSON(e)),n.uuid}if(this.isScene)this.background&&(this.background.isColor?r.background=this.background.toJSON():this.background.isTexture&&(r.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(r.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){r.geometry=i(e.geometries,this.geometry);let t=this.geometry.parameters;if(t!==void 0&&t.shapes!==void 0){let n=t.shapes;if(Array.isArray(n))for(let t=0,r=n.length;t<r;t++){let r=n[t];i(e.shapes,r)}else i(e.shapes,n)}}if(this.isSkinnedMesh&&(r.bindMode=this.bindMode,r.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(i(e.skeletons,this.skeleton),r.skeleton=this.skeleton.uuid)),this.material!==void 0){if(Array.isArray(this.material)){let t=[];for(let n=0,r=this.material.length;n<r;n++)t.push(i(e.materials,this.material[n]));r.material=t}else r.material=i(e.materials,this.material)}if(this.children.length>0){r.children=[];for(let t=0;t<this.children.length;t++)r.children.push(this.children[t].toJSON(e).object)}if(this.animations.length>0){r.animations=[];for(let t=0;t<this.animations.length;t++){let n=this.animations[t];r.animations.push(i(e.animations,n))}}if(t){let t=a(e.geometries),r=a(e.materials),i=a(e.textures),o=a(e.images),s=a(e.shapes),c=a(e.skeletons),l=a(e.animations),u=a(e.nodes);t.length>0&&(n.geometries=t),r.length>0&&(n.materials=r),i.length>0&&(n.textures=i),o.length>0&&(n.images=o),s.length>0&&(n.shapes=s),c.length>0&&(n.skeletons=c),l.length>0&&(n.animations=l),u.length>0&&(n.nodes=u)}return n.object=r,n;function a(e){let t=[];for(let n in e){let r=e[n];delete r.metadata,t.push(r)}return t}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot===null?null:e.pivot.clone(),this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let t=0;t<e.children.length;t++){let n=e.children[t];this.add(n.clone())}return this}dispose(){this.dispatchEvent({type:`dispose`})}};fi.DEFAULT_UP=new J(0,1,0),fi.DEFAULT_MATRIX_AUTO_UPDATE=!0,fi.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var pi=class extends fi{constructor(){super(),this.isGroup=!0,this.type=`Group`}},mi={type:`move`},hi=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new pi,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new pi,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new J,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new J),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new pi,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new J,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new J,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(e){return this._targetRay!==null&&this._targetRay.dispatchEvent(e),this._grip!==null&&this._grip.dispatchEvent(e),this._hand!==null&&this._hand.dispatchEvent(e),this}connect(e){if(e&&e.hand){let t=this._hand;if(t)for(let n of e.hand.values())this._getHandJoint(t,n)}return this.dispatchEvent({type:`connected`,data:e}),this}disconnect(e){return this.dispatchEvent({type:`disconnected`,data:e}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(e,t,n){let r=null,i=null,a=null,o=this._targetRay,s=this._grip,c=this._hand;if(e&&t.session.visibilityState!==`visible-blurred`){if(c&&e.hand){a=!0;for(let r of e.hand.values()){let e=t.getJointPose(r,n),i=this._getHandJoint(c,r);e!==null&&(i.matrix.fromArray(e.transform.matrix),i.matrix.decompose(i.position,i.quaternion,i.scale),i.matrixWorldNeedsUpdate=!0,i.jointRadius=e.radius),i.visible=e!==null}let r=c.joints[`index-finger-tip`],i=c.joints[`thumb-tip`],o=r.position.distanceTo(i.position);c.inputState.pinching&&o>.025?(c.inputState.pinching=!1,this.dispatchEvent({type:`pinchend`,handedness:e.handedness,target:this})):!c.inputState.pinching&&o<=.015&&(c.inputState.pinching=!0,this.dispatchEvent({type:`pinchstart`,handedness:e.handedness,target:this}))}else s!==null&&e.gripSpace&&(i=t.getPose(e.gripSpace,n),i!==null&&(s.matrix.fromArray(i.transform.matrix),s.matrix.decompose(s.position,s.quaternion,s.scale),s.matrixWorldNeedsUpdate=!0,i.linearVelocity?(s.hasLinearVelocity=!0,s.linearVelocity.copy(i.linearVelocity)):s.hasLinearVelocity=!1,i.angularVelocity?(s.hasAngularVelocity=!0,s.angularVelocity.copy(i.angularVelocity)):s.hasAngularVelocity=!1,s.eventsEnabled&&s.dispatchEvent({type:`gripUpdated`,data:e,target:this})));o!==null&&(r=t.getPose(e.targetRaySpace,n),r===null&&i!==null&&(r=i),r!==null&&(o.matrix.fromArray(r.transform.matrix),o.matrix.decompose(o.position,o.quaternion,o.scale),o.matrixWorldNeedsUpdate=!0,r.linearVelocity?(o.hasLinearVelocity=!0,o.linearVelocity.copy(r.linearVelocity)):o.hasLinearVelocity=!1,r.angularVelocity?(o.hasAngularVelocity=!0,o.angularVelocity.copy(r.angularVelocity)):o.hasAngularVelocity=!1,this.dispatchEvent(mi)))}return o!==null&&(o.visible=r!==null),s!==null&&(s.visible=i!==null),c!==null&&(c.visible=a!==null),this}_getHandJoint(e,t){if(e.joints[t.jointName]===void 0){let n=new pi;n.matrixAutoUpdate=!1,n.visible=!1,e.joints[t.jointName]=n,e.add(n)}return e.joints[t.jointName]}},gi={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},_i={h:0,s:0,l:0},vi={h:0,s:0,l:0};function yi(e,t,n){return n<0&&(n+=1),n>1&&--n,n<1/6?e+(t-e)*6*n:n<1/2?t:n<2/3?e+(t-e)*6*(2/3-n):e}var Z=class{constructor(e,t,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,n)}set(e,t,n){if(t===void 0&&n===void 0){let t=e;t&&t.isColor?this.copy(t):typeof t==`number`?this.setHex(t):typeof t==`string`&&this.setStyle(t)}else this.setRGB(e,t,n);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=Hn){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,X.colorSpaceToWorking(this,t),this}setRGB(e,t,n,r=X.workingColorSpace){return this.r=e,this.g=t,this.b=n,X.colorSpaceToWorking(this,r),this}setHSL(e,t,n,r=X.workingColorSpace){if(e=dr(e,1),t=K(t,0,1),n=K(n,0,1),t===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+t):n+t-n*t,i=2*n-r;this.r=yi(i,r,e+1/3),this.g=yi(i,r,e),this.b=yi(i,r,e-1/3)}return X.colorSpaceToWorking(this,r),this}setStyle(e,t=Hn){function n(t){t!==void 0&&parseFloat(t)<1&&W(`Color: Alpha component of `+e+` will be ignored.`)}let r;if(r=/^(\w+)\(([^\)]*)\)/.exec(e)){let i,a=r[1],o=r[2];switch(a){case`rgb`:case`rgba`:if(i=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(i[4]),this.setRGB(Math.min(255,parseInt(i[1],10))/255,Math.min(255,parseInt(i[2],10))/255,Math.min(255,parseInt(i[3],10))/255,t);if(i=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(i[4]),this.setRGB(Math.min(100,parseFloat(i[1]))/100,Math.min(100,parseFloat(i[2]))/100,Math.min(100,parseFloat(i[3]))/100,t);break;case`hsl`:case`hsla`:if(i=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(i[4]),this.setHSL(parseFloat(i[1])/360,parseFloat(i[2])/100,parseFloat(i[3])/100,t);break;default:W(`Color: Unknown color model `+e)}}else if(r=/^\#([A-Fa-f\d]+)$/.exec(e)){let n=r[1],i=n.length;if(i===3)return this.setRGB(parseInt(n.charAt(0),16)/15,parseInt(n.charAt(1),16)/15,parseInt(n.charAt(2),16)/15,t);if(i===6)return this.setHex(parseInt(n,16),t);W(`Color: Invalid hex color `+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=Hn){let n=gi[e.toLowerCase()];return n===void 0?W(`Color: Unknown color `+e):this.setHex(n,t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=wr(e.r),this.g=wr(e.g),this.b=wr(e.b),this}copyLinearToSRGB(e){return this.r=Tr(e.r),this.g=Tr(e.g),this.b=Tr(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=Hn){return X.workingToColorSpace(bi.copy(this),e),Math.round(K(bi.r*255,0,255))*65536+Math.round(K(bi.g*255,0,255))*256+Math.round(K(bi.b*255,0,255))}getHexString(e=Hn){return(`000000`+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=X.workingColorSpace){X.workingToColorSpace(bi.copy(this),t);let n=bi.r,r=bi.g,i=bi.b,a=Math.max(n,r,i),o=Math.min(n,r,i),s,c,l=(o+a)/2;if(o===a)s=0,c=0;else{let e=a-o;switch(c=l<=.5?e/(a+o):e/(2-a-o),a){case n:s=(r-i)/e+(r<i?6:0);break;case r:s=(i-n)/e+2;break;case i:s=(n-r)/e+4}s/=6}return e.h=s,e.s=c,e.l=l,e}getRGB(e,t=X.workingColorSpace){return X.workingToColorSpace(bi.copy(this),t),e.r=bi.r,e.g=bi.g,e.b=bi.b,e}getStyle(e=Hn){X.workingToColorSpace(bi.copy(this),e);let t=bi.r,n=bi.g,r=bi.b;return e===`srgb`?`rgb(${Math.round(t*255)},${Math.round(n*255)},${Math.round(r*255)})`:`color(${e} ${t.toFixed(3)} ${n.toFixed(3)} ${r.toFixed(3)})`}offsetHSL(e,t,n){return this.getHSL(_i),this.setHSL(_i.h+e,_i.s+t,_i.l+n)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,n){return this.r=e.r+(t.r-e.r)*n,this.g=e.g+(t.g-e.g)*n,this.b=e.b+(t.b-e.b)*n,this}lerpHSL(e,t){this.getHSL(_i),e.getHSL(vi);let n=fr(_i.h,vi.h,t),r=fr(_i.s,vi.s,t),i=fr(_i.l,vi.l,t);return this.setHSL(n,r,i),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){let t=this.r,n=this.g,r=this.b,i=e.elements;return this.r=i[0]*t+i[3]*n+i[6]*r,this.g=i[1]*t+i[4]*n+i[7]*r,this.b=i[2]*t+i[5]*n+i[8]*r,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},bi=new Z;Z.NAMES=gi;var xi=class extends fi{constructor(){super(),this.isScene=!0,this.type=`Scene`,this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Yr,this.environmentIntensity=1,this.environmentRotation=new Yr,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<`u`&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent(`observe`,{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background===null?null:e.background.clone(),this.environment=e.environment===null?null:e.environment.clone(),this.fog=e.fog===null?null:e.fog.clone(),this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial===null?null:e.overrideMaterial.clone(),this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){let t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}},Si=new J,Ci=new J,wi=new J,Ti=new J,Ei=new J,Di=new J,Oi=new J,ki=new J,Ai=new J,ji=new J,Mi=new Pr,Ni=new Pr,Pi=new Pr,Fi=class e{constructor(e=new J,t=new J,n=new J){this.a=e,this.b=t,this.c=n}static getNormal(e,t,n,r){r.subVectors(n,t),Si.subVectors(e,t),r.cross(Si);let i=r.lengthSq();return i>0?r.multiplyScalar(1/Math.sqrt(i)):r.set(0,0,0)}static getBarycoord(e,t,n,r,i){Si.subVectors(r,t),Ci.subVectors(n,t),wi.subVectors(e,t);let a=Si.dot(Si),o=Si.dot(Ci),s=Si.dot(wi),c=Ci.dot(Ci),l=Ci.dot(wi),u=a*c-o*o;if(u===0)return i.set(0,0,0),null;let d=1/u,f=(c*s-o*l)*d,p=(a*l-o*s)*d;return i.set(1-f-p,p,f)}static containsPoint(e,t,n,r){return this.getBarycoord(e,t,n,r,Ti)!==null&&Ti.x>=0&&Ti.y>=0&&Ti.x+Ti.y<=1}static getInterpolation(e,t,n,r,i,a,o,s){return this.getBarycoord(e,t,n,r,Ti)===null?(s.x=0,s.y=0,`z`in s&&(s.z=0),`w`in s&&(s.w=0),null):(s.setScalar(0),s.addScaledVector(i,Ti.x),s.addScaledVector(a,Ti.y),s.addScaledVector(o,Ti.z),s)}static getInterpolatedAttribute(e,t,n,r,i,a){return Mi.setScalar(0),Ni.setScalar(0),Pi.setScalar(0),Mi.fromBufferAttribute(e,t),Ni.fromBufferAttribute(e,n),Pi.fromBufferAttribute(e,r),a.setScalar(0),a.addScaledVector(Mi,i.x),a.addScaledVector(Ni,i.y),a.addScaledVector(Pi,i.z),a}static isFrontFacing(e,t,n,r){return Si.subVectors(n,t),Ci.subVectors(e,t),Si.cross(Ci).dot(r)<0}set(e,t,n){return this.a.copy(e),this.b.copy(t),this.c.copy(n),this}setFromPointsAndIndices(e,t,n,r){return this.a.copy(e[t]),this.b.copy(e[n]),this.c.copy(e[r]),this}setFromAttributeAndIndices(e,t,n,r){return this.a.fromBufferAttribute(e,t),this.b.fromBufferAttribute(e,n),this.c.fromBufferAttribute(e,r),this}clone(){return new this.constructor().copy(this)}copy(e){return this.a.copy(e.a),this.b.copy(e.b),this.c.copy(e.c),this}getArea(){return Si.subVectors(this.c,this.b),Ci.subVectors(this.a,this.b),Si.cross(Ci).length()*.5}getMidpoint(e){return e.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return e.getNormal(this.a,this.b,this.c,t)}getPlane(e){return e.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,n){return e.getBarycoord(t,this.a,this.b,this.c,n)}getInterpolation(t,n,r,i,a){return e.getInterpolation(t,this.a,this.b,this.c,n,r,i,a)}containsPoint(t){return e.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return e.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(e){return e.intersectsTriangle(this)}closestPointToPoint(e,t){let n=this.a,r=this.b,i=this.c,a,o;Ei.subVectors(r,n),Di.subVectors(i,n),ki.subVectors(e,n);let s=Ei.dot(ki),c=Di.dot(ki);if(s<=0&&c<=0)return t.copy(n);Ai.subVectors(e,r);let l=Ei.dot(Ai),u=Di.dot(Ai);if(l>=0&&u<=l)return t.copy(r);let d=s*u-l*c;if(d<=0&&s>=0&&l<=0&&s-l>0)return a=s/(s-l),t.copy(n).addScaledVector(Ei,a);ji.subVectors(e,i);let f=Ei.dot(ji),p=Di.dot(ji);if(p>=0&&f<=p)return t.copy(i);let m=f*c-s*p;if(m<=0&&c>=0&&p<=0)return o=c/(c-p),t.copy(n).addScaledVector(Di,o);let h=l*p-f*u;if(h<=0&&u-l>=0&&f-p>=0)return Oi.subVectors(i,r),o=(u-l)/(u-l+(f-p)),t.copy(r).addScaledVector(Oi,o);let g=1/(h+m+d);return a=m*g,o=d*g,t.copy(n).addScaledVector(Ei,a).addScaledVector(Di,o)}equals(e){return e.a.equals(this.a)&&e.b.equals(this.b)&&e.c.equals(this.c)}},Ii=class{constructor(e=new J(1/0,1/0,1/0),t=new J(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=e,this.max=t}set(e,t){return this.min.copy(e),this.max.copy(t),this}setFromArray(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t+=3)this.expandByPoint(Ri.fromArray(e,t));return this}setFromBufferAttribute(e){this.makeEmpty();for(let t=0,n=e.count;t<n;t++)this.expandByPoint(Ri.fromBufferAttribute(e,t));return this}setFromPoints(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t++)this.expandByPoint(e[t]);return this}setFromCenterAndSize(e,t){let n=Ri.copy(t).multiplyScalar(.5);return this.min.copy(e).sub(n),this.max.copy(e).add(n),this}setFromObject(e,t=!1){return this.makeEmpty(),this.expandByObject(e,t)}clone(){return new this.constructor().copy(this)}copy(e){return this.min.copy(e.min),this.max.copy(e.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(e){return this.isEmpty()?e.set(0,0,0):e.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(e){return this.isEmpty()?e.set(0,0,0):e.subVectors(this.max,this.min)}expandByPoint(e){return this.min.min(e),this.max.max(e),this}expandByVector(e){return this.min.sub(e),this.max.add(e),this}expandByScalar(e){return this.min.addScalar(-e),this.max.addScalar(e),this}expandByObject(e,t=!1){e.updateWorldMatrix(!1,!1);let n=e.geometry;if(n!==void 0){let r=n.getAttribute(`position`);if(t===!0&&r!==void 0&&e.isInstancedMesh!==!0&&e.isBatchedMesh!==!0)for(let t=0,n=r.count;t<n;t++)e.isMesh===!0?e.getVertexPosition(t,Ri):Ri.fromBufferAttribute(r,t),Ri.applyMatrix4(e.matrixWorld),this.expandByPoint(Ri);else e.boundingBox===void 0?(n.boundingBox===null&&n.computeBoundingBox(),zi.copy(n.boundingBox)):(e.boundingBox===null&&e.computeBoundingBox(),zi.copy(e.boundingBox)),zi.applyMatrix4(e.matrixWorld),this.union(zi)}let r=e.children;for(let e=0,n=r.length;e<n;e++)this.expandByObject(r[e],t);return this}containsPoint(e){return e.x>=this.min.x&&e.x<=this.max.x&&e.y>=this.min.y&&e.y<=this.max.y&&e.z>=this.min.z&&e.z<=this.max.z}containsBox(e){return this.min.x<=e.min.x&&e.max.x<=this.max.x&&this.min.y<=e.min.y&&e.max.y<=this.max.y&&this.min.z<=e.min.z&&e.max.z<=this.max.z}getParameter(e,t){return t.set((e.x-this.min.x)/(this.max.x-this.min.x),(e.y-this.min.y)/(this.max.y-this.min.y),(e.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(e){return e.max.x>=this.min.x&&e.min.x<=this.max.x&&e.max.y>=this.min.y&&e.min.y<=this.max.y&&e.max.z>=this.min.z&&e.min.z<=this.max.z}intersectsSphere(e){return this.clampPoint(e.center,Ri),Ri.distanceToSquared(e.center)<=e.radius*e.radius}intersectsPlane(e){let t,n;return e.normal.x>0?(t=e.normal.x*this.min.x,n=e.normal.x*this.max.x):(t=e.normal.x*this.max.x,n=e.normal.x*this.min.x),e.normal.y>0?(t+=e.normal.y*this.min.y,n+=e.normal.y*this.max.y):(t+=e.normal.y*this.max.y,n+=e.normal.y*this.min.y),e.normal.z>0?(t+=e.normal.z*this.min.z,n+=e.normal.z*this.max.z):(t+=e.normal.z*this.max.z,n+=e.normal.z*this.min.z),t<=-e.constant&&n>=-e.constant}intersectsTriangle(e){if(this.isEmpty())return!1;this.getCenter(Ki),qi.subVectors(this.max,Ki),Bi.subVectors(e.a,Ki),Vi.subVectors(e.b,Ki),Hi.subVectors(e.c,Ki),Ui.subVectors(Vi,Bi),Wi.subVectors(Hi,Vi),Gi.subVectors(Bi,Hi);let t=[0,-Ui.z,Ui.y,0,-Wi.z,Wi.y,0,-Gi.z,Gi.y,Ui.z,0,-Ui.x,Wi.z,0,-Wi.x,Gi.z,0,-Gi.x,-Ui.y,Ui.x,0,-Wi.y,Wi.x,0,-Gi.y,Gi.x,0];return!Xi(t,Bi,Vi,Hi,qi)||(t=[1,0,0,0,1,0,0,0,1],!Xi(t,Bi,Vi,Hi,qi))?!1:(Ji.crossVectors(Ui,Wi),t=[Ji.x,Ji.y,Ji.z],Xi(t,Bi,Vi,Hi,qi))}clampPoint(e,t){return t.copy(e).clamp(this.min,this.max)}distanceToPoint(e){return this.clampPoint(e,Ri).distanceTo(e)}getBoundingSphere(e){return this.isEmpty()?e.makeEmpty():(this.getCenter(e.center),e.radius=this.getSize(Ri).length()*.5),e}intersect(e){return this.min.max(e.min),this.max.min(e.max),this.isEmpty()&&this.makeEmpty(),this}union(e){return this.min.min(e.min),this.max.max(e.max),this}applyMatrix4(e){return this.isEmpty()||(Li[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(e),Li[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(e),Li[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(e),Li[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(e),Li[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(e),Li[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(e),Li[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(e),Li[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(e),this.setFromPoints(Li)),this}translate(e){return this.min.add(e),this.max.add(e),this}equals(e){return e.min.equals(this.min)&&e.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(e){return this.min.fromArray(e.min),this.max.fromArray(e.max),this}},Li=[new J,new J,new J,new J,new J,new J,new J,new J],Ri=new J,zi=new Ii,Bi=new J,Vi=new J,Hi=new J,Ui=new J,Wi=new J,Gi=new J,Ki=new J,qi=new J,Ji=new J,Yi=new J;function Xi(e,t,n,r,i){for(let a=0,o=e.length-3;a<=o;a+=3){Yi.fromArray(e,a);let o=i.x*Math.abs(Yi.x)+i.y*Math.abs(Yi.y)+i.z*Math.abs(Yi.z),s=t.dot(Yi),c=n.dot(Yi),l=r.dot(Yi);if(Math.max(-Math.max(s,c,l),Math.min(s,c,l))>o)return!1}return!0}var Zi=new J,Qi=new q,$i=0,ea=class extends or{constructor(e,t,n=!1){if(super(),Array.isArray(e))throw TypeError(`THREE.BufferAttribute: array should be a Typed Array.`);this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:$i++}),this.name=``,this.array=e,this.itemSize=t,this.count=e===void 0?0:e.length/t,this.normalized=n,this.usage=qn,this.updateRanges=[],this.gpuType=Pt,this.version=0,this._normalizationScale=e===void 0?void 0:mr(e)}onUploadCallback(){}set needsUpdate(e){e===!0&&this.version++}setUsage(e){return this.usage=e,this}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}copy(e){return this.name=e.name,this.array=new e.array.constructor(e.array),this.itemSize=e.itemSize,this.count=e.count,this.normalized=e.normalized,this.usage=e.usage,this.gpuType=e.gpuType,this._normalizationScale=e._normalizationScale,this}copyAt(e,t,n){e*=this.itemSize,n*=t.itemSize;for(let r=0,i=this.itemSize;r<i;r++)this.array[e+r]=t.array[n+r];return this}copyArray(e){return this.array.set(e),this}applyMatrix3(e){if(this.itemSize===2)for(let t=0,n=this.count;t<n;t++)Qi.fromBufferAttribute(this,t),Qi.applyMatrix3(e),this.setXY(t,Qi.x,Qi.y);else if(this.itemSize===3)for(let t=0,n=this.count;t<n;t++)Zi.fromBufferAttribute(this,t),Zi.applyMatrix3(e),this.setXYZ(t,Zi.x,Zi.y,Zi.z);return this}applyMatrix4(e){for(let t=0,n=this.count;t<n;t++)Zi.fromBufferAttribute(this,t),Zi.applyMatrix4(e),this.setXYZ(t,Zi.x,Zi.y,Zi.z);return this}applyNormalMatrix(e){for(let t=0,n=this.count;t<n;t++)Zi.fromBufferAttribute(this,t),Zi.applyNormalMatrix(e),this.setXYZ(t,Zi.x,Zi.y,Zi.z);return this}transformDirection(e){for(let t=0,n=this.count;t<n;t++)Zi.fromBufferAttribute(this,t),Zi.transformDirection(e),this.setXYZ(t,Zi.x,Zi.y,Zi.z);return this}set(e,t=0){return this.array.set(e,t),this}getComponent(e,t){let n=this.array[e*this.itemSize+t];return this.normalized&&(n=this._denormalize(n)),n}setComponent(e,t,n){return this.normalized&&(n=this._normalize(n)),this.array[e*this.itemSize+t]=n,this}getX(e){let t=this.array[e*this.itemSize];return this.normalized&&(t=this._denormalize(t)),t}setX(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize]=t,this}getY(e){let t=this.array[e*this.itemSize+1];return this.normalized&&(t=this._denormalize(t)),t}setY(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+1]=t,this}getZ(e){let t=this.array[e*this.itemSize+2];return this.normalized&&(t=this._denormalize(t)),t}setZ(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+2]=t,this}getW(e){let t=this.array[e*this.itemSize+3];return this.normalized&&(t=this._denormalize(t)),t}setW(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+3]=t,this}setXY(e,t,n){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n)),this.array[e+0]=t,this.array[e+1]=n,this}setXYZ(e,t,n,r){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),r=this._normalize(r)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=r,this}setXYZW(e,t,n,r,i){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),r=this._normalize(r),i=this._normalize(i)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=r,this.array[e+3]=i,this}onUpload(e){return this.onUploadCallback=e,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let e={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return e.name=this.name,e.usage=this.usage,e.gpuType=this.gpuType,e}dispose(){this.dispatchEvent({type:`dispose`})}_denormalize(e){let t=this._normalizationScale;return t===void 0?hr(e,this.array):Math.max(e/t,-1)}_normalize(e){let t=this._normalizationScale;return t===void 0?gr(e,this.array):Math.round(e*t)}},ta=class extends ea{constructor(e,t,n){super(new Uint16Array(e),t,n)}},na=class extends ea{constructor(e,t,n){super(new Uint32Array(e),t,n)}},ra=class extends ea{constructor(e,t,n){super(new Float32Array(e),t,n)}},ia=new Ii,aa=new J,oa=new J,sa=class{constructor(e=new J,t=-1){this.isSphere=!0,this.center=e,this.radius=t}set(e,t){return this.center.copy(e),this.radius=t,this}setFromPoints(e,t){let n=this.center;t===void 0?ia.setFromPoints(e).getCenter(n):n.copy(t);let r=0;for(let t=0,i=e.length;t<i;t++)r=Math.max(r,n.distanceToSquared(e[t]));return this.radius=Math.sqrt(r),this}copy(e){return this.center.copy(e.center),this.radius=e.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(e){return e.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(e){return e.distanceTo(this.center)-this.radius}intersectsSphere(e){let t=this.radius+e.radius;return e.center.distanceToSquared(this.center)<=t*t}intersectsBox(e){return e.intersectsSphere(this)}intersectsPlane(e){return Math.abs(e.distanceToPoint(this.center))<=this.radius}clampPoint(e,t){let n=this.center.distanceToSquared(e);return t.copy(e),n>this.radius*this.radius&&(t.sub(this.center).normalize(),t.multiplyScalar(this.radius).add(this.center)),t}getBoundingBox(e){return this.isEmpty()?(e.makeEmpty(),e):(e.set(this.center,this.center),e.expandByScalar(this.radius),e)}applyMatrix4(e){return this.center.applyMatrix4(e),this.radius*=e.getMaxScaleOnAxis(),this}translate(e){return this.center.add(e),this}expandByPoint(e){if(this.isEmpty())return this.center.copy(e),this.radius=0,this;aa.subVectors(e,this.center);let t=aa.lengthSq();if(t>this.radius*this.radius){let e=Math.sqrt(t),n=(e-this.radius)*.5;this.center.addScaledVector(aa,n/e),this.radius+=n}return this}union(e){return e.isEmpty()?this:this.isEmpty()?(this.copy(e),this):(this.center.equals(e.center)===!0?this.radius=Math.max(this.radius,e.radius):(oa.subVectors(e.center,this.center).setLength(e.radius),this.expandByPoint(aa.copy(e.center).add(oa)),this.expandByPoint(aa.copy(e.center).sub(oa))),this)}equals(e){return e.center.equals(this.center)&&e.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(e){return this.radius=e.radius,this.center.fromArray(e.center),this}},ca=0,la=new zr,ua=new fi,da=new J,fa=new Ii,pa=new Ii,ma=new J,ha=class e extends or{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:ca++}),this.uuid=ur(),this.name=``,this.type=`BufferGeometry`,this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(e){return this.index=Array.isArray(e)?new(Xn(e)?na:ta)(e,1):e,this}setIndirect(e,t=0){return this.indirect=e,this.indirectOffset=t,this}getIndirect(){return this.indirect}getAttribute(e){return this.attributes[e]}setAttribute(e,t){return this.attributes[e]=t,this}deleteAttribute(e){return delete this.attributes[e],this}hasAttribute(e){return this.attributes[e]!==void 0}addGroup(e,t,n=0){this.groups.push({start:e,count:t,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(e,t){this.drawRange.start=e,this.drawRange.count=t}applyMatrix4(e){let t=this.attributes.position;t!==void 0&&(t.applyMatrix4(e),t.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let t=new Y().getNormalMatrix(e);n.applyNormalMatrix(t),n.needsUpdate=!0}let r=this.attributes.tangent;return r!==void 0&&(r.transformDirection(e),r.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(e){return la.makeRotationFromQuaternion(e),this.applyMatrix4(la),this}rotateX(e){return la.makeRotationX(e),this.applyMatrix4(la),this}rotateY(e){return la.makeRotationY(e),this.applyMatrix4(la),this}rotateZ(e){return la.makeRotationZ(e),this.applyMatrix4(la),this}translate(e,t,n){return la.makeTranslation(e,t,n),this.applyMatrix4(la),this}scale(e,t,n){return la.makeScale(e,t,n),this.applyMatrix4(la),this}lookAt(e){return ua.lookAt(e),ua.updateMatrix(),this.applyMatrix4(ua.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(da).negate(),this.translate(da.x,da.y,da.z),this}setFromPoints(e){let t=this.getAttribute(`position`);if(t===void 0){let t=[];for(let n=0,r=e.length;n<r;n++){let r=e[n];t.push(r.x,r.y,r.z||0)}this.setAttribute(`position`,new ra(t,3))}else{let n=Math.min(e.length,t.count);for(let r=0;r<n;r++){let n=e[r];t.setXYZ(r,n.x,n.y,n.z||0)}e.length>t.count&&W(`BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry.`),t.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Ii);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute)G(`BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.`,this),this.boundingBox.set(new J(-1/0,-1/0,-1/0),new J(1/0,1/0,1/0));else{if(e!==void 0){if(this.boundingBox.setFromBufferAttribute(e),t)for(let e=0,n=t.length;e<n;e++){let n=t[e];fa.setFromBufferAttribute(n),this.morphTargetsRelative?(ma.addVectors(this.boundingBox.min,fa.min),this.boundingBox.expandByPoint(ma),ma.addVectors(this.boundingBox.max,fa.max),this.boundingBox.expandByPoint(ma)):(this.boundingBox.expandByPoint(fa.min),this.boundingBox.expandByPoint(fa.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&G(`BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.`,this)}}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new sa);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute)G(`BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.`,this),this.boundingSphere.set(new J,1/0);else if(e){let n=this.boundingSphere.center;if(fa.setFromBufferAttribute(e),t)for(let e=0,n=t.length;e<n;e++){let n=t[e];pa.setFromBufferAttribute(n),this.morphTargetsRelative?(ma.addVectors(fa.min,pa.min),fa.expandByPoint(ma),ma.addVectors(fa.max,pa.max),fa.expandByPoint(ma)):(fa.expandByPoint(pa.min),fa.expandByPoint(pa.max))}fa.getCenter(n);let r=0;for(let t=0,i=e.count;t<i;t++)ma.fromBufferAttribute(e,t),r=Math.max(r,n.distanceToSquared(ma));if(t)for(let i=0,a=t.length;i<a;i++){let a=t[i],o=this.morphTargetsRelative;for(let t=0,i=a.count;t<i;t++)ma.fromBufferAttribute(a,t),o&&(da.fromBufferAttribute(e,t),ma.add(da)),r=Math.max(r,n.distanceToSquared(ma))}this.boundingSphere.radius=Math.sqrt(r),isNaN(this.boundingSphere.radius)&&G(`BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.`,this)}}computeTangents(){let e=this.index,t=this.attributes;if(e===null||t.position===void 0||t.normal===void 0||t.uv===void 0){G(`BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)`);return}let n=t.position,r=t.normal,i=t.uv,a=this.getAttribute(`tangent`);(a===void 0||a.count!==n.count)&&(a=new ea(new Float32Array(4*n.count),4),this.setAttribute(`tangent`,a));let o=[],s=[],c=new Uint8Array(n.count);for(let e=0;e<n.count;e++)o[e]=new J,s[e]=new J;let l=new J,u=new J,d=new J,f=new q,p=new q,m=new q,h=new J,g=new J;function _(e,t,r){c[e]=c[t]=c[r]=1,l.fromBufferAttribute(n,e),u.fromBufferAttribute(n,t),d.fromBufferAttribute(n,r),f.fromBufferAttribute(i,e),p.fromBufferAttribute(i,t),m.fromBufferAttribute(i,r),u.sub(l),d.sub(l),p.sub(f),m.sub(f);let a=1/(p.x*m.y-m.x*p.y);isFinite(a)&&(h.copy(u).multiplyScalar(m.y).addScaledVector(d,-p.y).multiplyScalar(a),g.copy(d).multiplyScalar(p.x).addScaledVector(u,-m.x).multiplyScalar(a),o[e].add(h),o[t].add(h),o[r].add(h),s[e].add(g),s[t].add(g),s[r].add(g))}let v=this.groups;v.length===0&&(v=[{start:0,count:e.count}]);for(let t=0,n=v.length;t<n;++t){let n=v[t],r=n.start,i=n.count;for(let t=r,n=r+i;t<n;t+=3)_(e.getX(t+0),e.getX(t+1),e.getX(t+2))}let y=new J,b=new J,x=new J,S=new J;function C(e){x.fromBufferAttribute(r,e),S.copy(x);let t=o[e];y.copy(t),y.sub(x.multiplyScalar(x.dot(t))).normalize(),b.crossVectors(S,t);let n=b.dot(s[e])<0?-1:1;a.setXYZW(e,y.x,y.y,y.z,n)}for(let e=0,t=n.count;e<t;++e)c[e]&&C(e);this._transformed=!0}computeVertexNormals(){let e=this.index,t=this.getAttribute(`position`);if(t!==void 0){let n=this.getAttribute(`normal`);if(n===void 0||n.count!==t.count)n=new ea(new Float32Array(t.count*3),3),this.setAttribute(`normal`,n);else for(let e=0,t=n.count;e<t;e++)n.setXYZ(e,0,0,0);let r=new J,i=new J,a=new J,o=new J,s=new J,c=new J,l=new J,u=new J;if(e)for(let d=0,f=e.count;d<f;d+=3){let f=e.getX(d+0),p=e.getX(d+1),m=e.getX(d+2);r.fromBufferAttribute(t,f),i.fromBufferAttribute(t,p),a.fromBufferAttribute(t,m),l.subVectors(a,i),u.subVectors(r,i),l.cross(u),o.fromBufferAttribute(n,f),s.fromBufferAttribute(n,p),c.fromBufferAttribute(n,m),o.add(l),s.add(l),c.add(l),n.setXYZ(f,o.x,o.y,o.z),n.setXYZ(p,s.x,s.y,s.z),n.setXYZ(m,c.x,c.y,c.z)}else for(let e=0,o=t.count;e<o;e+=3)r.fromBufferAttribute(t,e+0),i.fromBufferAttribute(t,e+1),a.fromBufferAttribute(t,e+2),l.subVectors(a,i),u.subVectors(r,i),l.cross(u),n.setXYZ(e+0,l.x,l.y,l.z),n.setXYZ(e+1,l.x,l.y,l.z),n.setXYZ(e+2,l.x,l.y,l.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let e=this.attributes.normal;for(let t=0,n=e.count;t<n;t++)ma.fromBufferAttribute(e,t),ma.normalize(),e.setXYZ(t,ma.x,ma.y,ma.z)}toNonIndexed(){function t(e,t){let n=e.array,r=e.itemSize,i=e.normalized,a=new n.constructor(t.length*r),o=0,s=0;for(let i=0,c=t.length;i<c;i++){o=e.isInterleavedBufferAttribute?t[i]*e.data.stride+e.offset:t[i]*r;for(let e=0;e<r;e++)a[s++]=n[o++]}return new ea(a,r,i)}if(this.index===null)return W(`BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed.`),this;let n=new e,r=this.index.array,i=this.attributes;for(let e in i){let a=i[e],o=t(a,r);n.setAttribute(e,o)}let a=this.morphAttributes;for(let e in a){let i=[],o=a[e];for(let e=0,n=o.length;e<n;e++){let n=o[e],a=t(n,r);i.push(a)}n.morphAttributes[e]=i}n.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let e=0,t=o.length;e<t;e++){let t=o[e];n.addGroup(t.start,t.count,t.materialIndex)}return n}toJSON(){let e={metadata:{version:4.7,type:`BufferGeometry`,generator:`BufferGeometry.toJSON`}};if(e.uuid=this.uuid,e.type=this.parameters!==void 0&&this._transformed===!0?`BufferGeometry`:this.type,e.name=this.name,Object.keys(this.userData).length>0&&(e.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let t=this.parameters;for(let n in t)t[n]!==void 0&&(e[n]=t[n]);return e}e.data={attributes:{}};let t=this.index;t!==null&&(e.data.index={type:t.array.constructor.name,array:Array.prototype.slice.call(t.array)});let n=this.attributes;for(let t in n){let r=n[t];e.data.attributes[t]=r.toJSON(e.data)}let r={},i=!1;for(let t in this.morphAttributes){let n=this.morphAttributes[t],a=[];for(let t=0,r=n.length;t<r;t++){let r=n[t];a.push(r.toJSON(e.data))}a.length>0&&(r[t]=a,i=!0)}i&&(e.data.morphAttributes=r,e.data.morphTargetsRelative=this.morphTargetsRelative);let a=this.groups;a.length>0&&(e.data.groups=JSON.parse(JSON.stringify(a)));let o=this.boundingSphere;return o!==null&&(e.data.boundingSphere=o.toJSON()),e}clone(){return new this.constructor().copy(this)}copy(e){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let t={};this.name=e.name;let n=e.index;n!==null&&this.setIndex(n.clone());let r=e.attributes;for(let e in r){let n=r[e];this.setAttribute(e,n.clone(t))}let i=e.morphAttributes;for(let e in i){let n=[],r=i[e];for(let e=0,i=r.length;e<i;e++)n.push(r[e].clone(t));this.morphAttributes[e]=n}this.morphTargetsRelative=e.morphTargetsRelative;let a=e.groups;for(let e=0,t=a.length;e<t;e++){let t=a[e];this.addGroup(t.start,t.count,t.materialIndex)}let o=e.boundingBox;o!==null&&(this.boundingBox=o.clone());let s=e.boundingSphere;return s!==null&&(this.boundingSphere=s.clone()),this.drawRange.start=e.drawRange.start,this.drawRange.count=e.drawRange.count,this.userData=e.userData,this._transformed=e._transformed,this}dispose(){this.dispatchEvent({type:`dispose`})}},ga=new J,_a=new J,va=new Y,ya=class{constructor(e=new J(1,0,0),t=0){this.isPlane=!0,this.normal=e,this.constant=t}set(e,t){return this.normal.copy(e),this.constant=t,this}setComponents(e,t,n,r){return this.normal.set(e,t,n),this.constant=r,this}setFromNormalAndCoplanarPoint(e,t){return this.normal.copy(e),this.constant=-t.dot(this.normal),this}setFromCoplanarPoints(e,t,n){let r=ga.subVectors(n,t).cross(_a.subVectors(e,t)).normalize();return this.setFromNormalAndCoplanarPoint(r,e),this}copy(e){return this.normal.copy(e.normal),this.constant=e.constant,this}normalize(){let e=1/this.normal.length();return this.normal.multiplyScalar(e),this.constant*=e,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(e){return this.normal.dot(e)+this.constant}distanceToSphere(e){return this.distanceToPoint(e.center)-e.radius}projectPoint(e,t){return t.copy(e).addScaledVector(this.normal,-this.distanceToPoint(e))}intersectLine(e,t,n=!0){let r=e.delta(ga),i=this.normal.dot(r);if(i===0)return this.distanceToPoint(e.start)===0?t.copy(e.start):null;let a=-(e.start.dot(this.normal)+this.constant)/i;return n===!0&&(a<0||a>1)?null:t.copy(e.start).addScaledVector(r,a)}intersectsLine(e){let t=this.distanceToPoint(e.start),n=this.distanceToPoint(e.end);return t<0&&n>0||n<0&&t>0}intersectsBox(e){return e.intersectsPlane(this)}intersectsSphere(e){return e.intersectsPlane(this)}coplanarPoint(e){return e.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(e,t){let n=t||va.getNormalMatrix(e),r=this.coplanarPoint(ga).applyMatrix4(e),i=this.normal.applyMatrix3(n).normalize();return this.constant=-r.dot(i),this}translate(e){return this.constant-=e.dot(this.normal),this}equals(e){return e.normal.equals(this.normal)&&e.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(e){return this.normal.fromArray(e.normal),this.constant=e.constant,this}},ba=0,xa=class extends or{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:ba++}),this.uuid=ur(),this.name=``,this.type=`Material`,this.blending=1,this.side=0,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=204,this.blendDst=205,this.blendEquation=100,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Z(0,0,0),this.blendAlpha=0,this.depthFunc=3,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=519,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Kn,this.stencilZFail=Kn,this.stencilZPass=Kn,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(e){this._alphaTest>0!=e>0&&this.version++,this._alphaTest=e}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(e){if(e!==void 0)for(let t in e){let n=e[t];if(n===void 0){W(`Material: parameter '${t}' has value of undefined.`);continue}let r=this[t];r===void 0?W(`Material: '${t}' is not a property of THREE.${this.type}.`):r&&r.isColor?r.set(n):r&&r.isVector2&&n&&n.isVector2||r&&r.isEuler&&n&&n.isEuler||r&&r.isVector3&&n&&n.isVector3?r.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e==`string`;t&&(e={textures:{},images:{}});let n={metadata:{version:4.7,type:`Material`,generator:`Material.toJSON`}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(e).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(e).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(e).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(e).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(e).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(e).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(e).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(e).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(e).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(e).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(e).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(e).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(e).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(e).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(e).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(e).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(e).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(e).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(e).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(e).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(e).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(e).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(e).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(e).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(e).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(e).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(e).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(e=>e.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function r(e){let t=[];for(let n in e){let r=e[n];delete r.metadata,t.push(r)}return t}if(t){let t=r(e.textures),i=r(e.images);t.length>0&&(n.textures=t),i.length>0&&(n.images=i)}return n}fromJSON(e,t){if(e.uuid!==void 0&&(this.uuid=e.uuid),e.name!==void 0&&(this.name=e.name),e.color!==void 0&&this.color!==void 0&&this.color.setHex(e.color),e.roughness!==void 0&&(this.roughness=e.roughness),e.metalness!==void 0&&(this.metalness=e.metalness),e.sheen!==void 0&&(this.sheen=e.sheen),e.sheenColor!==void 0&&(this.sheenColor=new Z().setHex(e.sheenColor)),e.sheenRoughness!==void 0&&(this.sheenRoughness=e.sheenRoughness),e.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(e.emissive),e.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(e.specular),e.specularIntensity!==void 0&&(this.specularIntensity=e.specularIntensity),e.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(e.specularColor),e.shininess!==void 0&&(this.shininess=e.shininess),e.clearcoat!==void 0&&(this.clearcoat=e.clearcoat),e.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=e.clearcoatRoughness),e.diffuseRoughness!==void 0&&(this.diffuseRoughness=e.diffuseRoughness),e.dispersion!==void 0&&(this.dispersion=e.dispersion),e.retroreflectivity!==void 0&&(this.retroreflectivity=e.retroreflectivity),e.iridescence!==void 0&&(this.iridescence=e.iridescence),e.iridescenceIOR!==void 0&&(this.iridescenceIOR=e.iridescenceIOR),e.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessMinimum),e.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=e.iridescenceThicknessMaximum),e.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=e.iridescenceThicknessRange[1]),e.transmission!==void 0&&(this.transmission=e.transmission),e.thickness!==void 0&&(this.thickness=e.thickness),e.attenuationDistance!==void 0&&(this.attenuationDistance=e.attenuationDistance),e.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(e.attenuationColor),e.anisotropy!==void 0&&(this.anisotropy=e.anisotropy),e.anisotropyRotation!==void 0&&(this.anisotropyRotation=e.anisotropyRotation),e.fog!==void 0&&(this.fog=e.fog),e.flatShading!==void 0&&(this.flatShading=e.flatShading),e.blending!==void 0&&(this.blending=e.blending),e.combine!==void 0&&(this.combine=e.combine),e.side!==void 0&&(this.side=e.side),e.shadowSide!==void 0&&(this.shadowSide=e.shadowSide),e.opacity!==void 0&&(this.opacity=e.opacity),e.transparent!==void 0&&(this.transparent=e.transparent),e.alphaTest!==void 0&&(this.alphaTest=e.alphaTest),e.alphaHash!==void 0&&(this.alphaHash=e.alphaHash),e.depthFunc!==void 0&&(this.depthFunc=e.depthFunc),e.depthTest!==void 0&&(this.depthTest=e.depthTest),e.depthWrite!==void 0&&(this.depthWrite=e.depthWrite),e.colorWrite!==void 0&&(this.colorWrite=e.colorWrite),e.clippingPlanes!==void 0&&(this.clippingPlanes=e.clippingPlanes.map(e=>new ya().fromJSON(e))),e.clipIntersection!==void 0&&(this.clipIntersection=e.clipIntersection),e.clipShadows!==void 0&&(this.clipShadows=e.clipShadows),e.depthPacking!==void 0&&(this.depthPacking=e.depthPacking),e.blendSrc!==void 0&&(this.blendSrc=e.blendSrc),e.blendDst!==void 0&&(this.blendDst=e.blendDst),e.blendEquation!==void 0&&(this.blendEquation=e.blendEquation),e.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=e.blendSrcAlpha),e.blendDstAlpha!==void 0&&(this.blendDstAlpha=e.blendDstAlpha),e.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=e.blendEquationAlpha),e.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(e.blendColor),e.blendAlpha!==void 0&&(this.blendAlpha=e.blendAlpha),e.stencilWriteMask!==void 0&&(this.stencilWriteMask=e.stencilWriteMask),e.stencilFunc!==void 0&&(this.stencilFunc=e.stencilFunc),e.stencilRef!==void 0&&(this.stencilRef=e.stencilRef),e.stencilFuncMask!==void 0&&(this.stencilFuncMask=e.stencilFuncMask),e.stencilFail!==void 0&&(this.stencilFail=e.stencilFail),e.stencilZFail!==void 0&&(this.stencilZFail=e.stencilZFail),e.stencilZPass!==void 0&&(this.stencilZPass=e.stencilZPass),e.stencilWrite!==void 0&&(this.stencilWrite=e.stencilWrite),e.wireframe!==void 0&&(this.wireframe=e.wireframe),e.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=e.wireframeLinewidth),e.wireframeLinecap!==void 0&&(this.wireframeLinecap=e.wireframeLinecap),e.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=e.wireframeLinejoin),e.rotation!==void 0&&(this.rotation=e.rotation),e.linewidth!==void 0&&(this.linewidth=e.linewidth),e.linecap!==void 0&&(this.linecap=e.linecap),e.linejoin!==void 0&&(this.linejoin=e.linejoin),e.dashSize!==void 0&&(this.dashSize=e.dashSize),e.gapSize!==void 0&&(this.gapSize=e.gapSize),e.scale!==void 0&&(this.scale=e.scale),e.polygonOffset!==void 0&&(this.polygonOffset=e.polygonOffset),e.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=e.polygonOffsetFactor),e.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=e.polygonOffsetUnits),e.dithering!==void 0&&(this.dithering=e.dithering),e.alphaToCoverage!==void 0&&(this.alphaToCoverage=e.alphaToCoverage),e.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=e.premultipliedAlpha),e.forceSinglePass!==void 0&&(this.forceSinglePass=e.forceSinglePass),e.allowOverride!==void 0&&(this.allowOverride=e.allowOverride),e.visible!==void 0&&(this.visible=e.visible),e.toneMapped!==void 0&&(this.toneMapped=e.toneMapped),e.userData!==void 0&&(this.userData=e.userData),e.vertexColors!==void 0&&(this.vertexColors=typeof e.vertexColors==`number`?e.vertexColors>0:e.vertexColors),e.size!==void 0&&(this.size=e.size),e.sizeAttenuation!==void 0&&(this.sizeAttenuation=e.sizeAttenuation),e.map!==void 0&&(this.map=t[e.map]||null),e.matcap!==void 0&&(this.matcap=t[e.matcap]||null),e.alphaMap!==void 0&&(this.alphaMap=t[e.alphaMap]||null),e.bumpMap!==void 0&&(this.bumpMap=t[e.bumpMap]||null),e.bumpScale!==void 0&&(this.bumpScale=e.bumpScale),e.normalMap!==void 0&&(this.normalMap=t[e.normalMap]||null),e.normalMapType!==void 0&&(this.normalMapType=e.normalMapType),e.normalScale!==void 0){let t=e.normalScale;Array.isArray(t)===!1&&(t=[t,t]),this.normalScale=new q().fromArray(t)}return e.displacementMap!==void 0&&(this.displacementMap=t[e.displacementMap]||null),e.displacementScale!==void 0&&(this.displacementScale=e.displacementScale),e.displacementBias!==void 0&&(this.displacementBias=e.displacementBias),e.roughnessMap!==void 0&&(this.roughnessMap=t[e.roughnessMap]||null),e.metalnessMap!==void 0&&(this.metalnessMap=t[e.metalnessMap]||null),e.emissiveMap!==void 0&&(this.emissiveMap=t[e.emissiveMap]||null),e.emissiveIntensity!==void 0&&(this.emissiveIntensity=e.emissiveIntensity),e.specularMap!==void 0&&(this.specularMap=t[e.specularMap]||null),e.specularIntensityMap!==void 0&&(this.specularIntensityMap=t[e.specularIntensityMap]||null),e.specularColorMap!==void 0&&(this.specularColorMap=t[e.specularColorMap]||null),e.envMap!==void 0&&(this.envMap=t[e.envMap]||null),e.envMapRotation!==void 0&&this.envMapRotation.fromArray(e.envMapRotation),e.envMapIntensity!==void 0&&(this.envMapIntensity=e.envMapIntensity),e.reflectivity!==void 0&&(this.reflectivity=e.reflectivity),e.refractionRatio!==void 0&&(this.refractionRatio=e.refractionRatio),e.lightMap!==void 0&&(this.lightMap=t[e.lightMap]||null),e.lightMapIntensity!==void 0&&(this.lightMapIntensity=e.lightMapIntensity),e.aoMap!==void 0&&(this.aoMap=t[e.aoMap]||null),e.aoMapIntensity!==void 0&&(this.aoMapIntensity=e.aoMapIntensity),e.gradientMap!==void 0&&(this.gradientMap=t[e.gradientMap]||null),e.clearcoatMap!==void 0&&(this.clearcoatMap=t[e.clearcoatMap]||null),e.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=t[e.clearcoatRoughnessMap]||null),e.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=t[e.clearcoatNormalMap]||null),e.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new q().fromArray(e.clearcoatNormalScale)),e.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=t[e.diffuseRoughnessMap]||null),e.iridescenceMap!==void 0&&(this.iridescenceMap=t[e.iridescenceMap]||null),e.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=t[e.iridescenceThicknessMap]||null),e.transmissionMap!==void 0&&(this.transmissionMap=t[e.transmissionMap]||null),e.thicknessMap!==void 0&&(this.thicknessMap=t[e.thicknessMap]||null),e.anisotropyMap!==void 0&&(this.anisotropyMap=t[e.anisotropyMap]||null),e.sheenColorMap!==void 0&&(this.sheenColorMap=t[e.sheenColorMap]||null),e.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=t[e.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(e){this.name=e.name,this.blending=e.blending,this.side=e.side,this.vertexColors=e.vertexColors,this.opacity=e.opacity,this.transparent=e.transparent,this.blendSrc=e.blendSrc,this.blendDst=e.blendDst,this.blendEquation=e.blendEquation,this.blendSrcAlpha=e.blendSrcAlpha,this.blendDstAlpha=e.blendDstAlpha,this.blendEquationAlpha=e.blendEquationAlpha,this.blendColor.copy(e.blendColor),this.blendAlpha=e.blendAlpha,this.depthFunc=e.depthFunc,this.depthTest=e.depthTest,this.depthWrite=e.depthWrite,this.stencilWriteMask=e.stencilWriteMask,this.stencilFunc=e.stencilFunc,this.stencilRef=e.stencilRef,this.stencilFuncMask=e.stencilFuncMask,this.stencilFail=e.stencilFail,this.stencilZFail=e.stencilZFail,this.stencilZPass=e.stencilZPass,this.stencilWrite=e.stencilWrite;let t=e.clippingPlanes,n=null;if(t!==null){let e=t.length;n=Array(e);for(let r=0;r!==e;++r)n[r]=t[r].clone()}return this.clippingPlanes=n,this.clipIntersection=e.clipIntersection,this.clipShadows=e.clipShadows,this.shadowSide=e.shadowSide,this.colorWrite=e.colorWrite,this.precision=e.precision,this.polygonOffset=e.polygonOffset,this.polygonOffsetFactor=e.polygonOffsetFactor,this.polygonOffsetUnits=e.polygonOffsetUnits,this.dithering=e.dithering,this.alphaTest=e.alphaTest,this.alphaHash=e.alphaHash,this.alphaToCoverage=e.alphaToCoverage,this.premultipliedAlpha=e.premultipliedAlpha,this.forceSinglePass=e.forceSinglePass,this.allowOverride=e.allowOverride,this.visible=e.visible,this.toneMapped=e.toneMapped,this.userData=JSON.parse(JSON.stringify(e.userData)),this}dispose(){this.dispatchEvent({type:`dispose`})}set needsUpdate(e){e===!0&&this.version++}},Sa=new J,Ca=new J,wa=new J,Ta=new J,Ea=class{constructor(e=new J,t=new J(0,0,-1)){this.origin=e,this.direction=t}set(e,t){return this.origin.copy(e),this.direction.copy(t),this}copy(e){return this.origin.copy(e.origin),this.direction.copy(e.direction),this}at(e,t){return t.copy(this.origin).addScaledVector(this.direction,e)}lookAt(e){return this.direction.copy(e).sub(this.origin).normalize(),this}recast(e){return this.origin.copy(this.at(e,Sa)),this}closestPointToPoint(e,t){t.subVectors(e,this.origin);let n=t.dot(this.direction);return n<0?t.copy(this.origin):t.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(e){return Math.sqrt(this.distanceSqToPoint(e))}distanceSqToPoint(e){let t=Sa.subVectors(e,this.origin).dot(this.direction);return t<0?this.origin.distanceToSquared(e):(Sa.copy(this.origin).addScaledVector(this.direction,t),Sa.distanceToSquared(e))}distanceSqToSegment(e,t,n,r){Ca.copy(e).add(t).multiplyScalar(.5),wa.copy(t).sub(e).normalize(),Ta.copy(this.origin).sub(Ca);let i=e.distanceTo(t)*.5,a=-this.direction.dot(wa),o=Ta.dot(this.direction),s=-Ta.dot(wa),c=Ta.lengthSq(),l=Math.abs(1-a*a),u,d,f,p;if(l>0){if(u=a*s-o,d=a*o-s,p=i*l,u>=0){if(d>=-p){if(d<=p){let e=1/l;u*=e,d*=e,f=u*(u+a*d+2*o)+d*(a*u+d+2*s)+c}else d=i,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*s)+c}else d=-i,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*s)+c}else d<=-p?(u=Math.max(0,-(-a*i+o)),d=u>0?-i:Math.min(Math.max(-i,-s),i),f=-u*u+d*(d+2*s)+c):d<=p?(u=0,d=Math.min(Math.max(-i,-s),i),f=d*(d+2*s)+c):(u=Math.max(0,-(a*i+o)),d=u>0?i:Math.min(Math.max(-i,-s),i),f=-u*u+d*(d+2*s)+c)}else d=a>0?-i:i,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*s)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,u),r&&r.copy(Ca).addScaledVector(wa,d),f}intersectSphere(e,t){if(e.radius<0)return null;Sa.subVectors(e.center,this.origin);let n=Sa.dot(this.direction),r=Sa.dot(Sa)-n*n,i=e.radius*e.radius;if(r>i)return null;let a=Math.sqrt(i-r),o=n-a,s=n+a;return s<0?null:o<0?this.at(s,t):this.at(o,t)}intersectsSphere(e){return e.radius<0?!1:this.distanceSqToPoint(e.center)<=e.radius*e.radius}distanceToPlane(e){let t=e.normal.dot(this.direction);if(t===0)return e.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(e.normal)+e.constant)/t;return n>=0?n:null}intersectPlane(e,t){let n=this.distanceToPlane(e);return n===null?null:this.at(n,t)}intersectsPlane(e){let t=e.distanceToPoint(this.origin);return t===0||e.normal.dot(this.direction)*t<0}intersectBox(e,t){let n,r,i,a,o,s,c=1/this.direction.x,l=1/this.direction.y,u=1/this.direction.z,d=this.origin;return c>=0?(n=(e.min.x-d.x)*c,r=(e.max.x-d.x)*c):(n=(e.max.x-d.x)*c,r=(e.min.x-d.x)*c),l>=0?(i=(e.min.y-d.y)*l,a=(e.max.y-d.y)*l):(i=(e.max.y-d.y)*l,a=(e.min.y-d.y)*l),n>a||i>r||((i>n||isNaN(n))&&(n=i),(a<r||isNaN(r))&&(r=a),u>=0?(o=(e.min.z-d.z)*u,s=(e.max.z-d.z)*u):(o=(e.max.z-d.z)*u,s=(e.min.z-d.z)*u),n>s||o>r)||((o>n||n!==n)&&(n=o),(s<r||r!==r)&&(r=s),r<0)?null:this.at(n>=0?n:r,t)}intersectsBox(e){return this.intersectBox(e,Sa)!==null}intersectTriangle(e,t,n,r,i){let a=this.origin,o=this.direction,s=o.x,c=o.y,l=o.z,u=e.x-a.x,d=e.y-a.y,f=e.z-a.z,p=t.x-a.x,m=t.y-a.y,h=t.z-a.z,g=n.x-a.x,_=n.y-a.y,v=n.z-a.z,y=Math.abs(s),b=Math.abs(c),x=Math.abs(l),S,C,w,T,E,D,O,k,A,j,M,N;if(y>=b&&y>=x?(w=s,D=u,A=p,N=g,s>=0?(S=c,C=l,T=d,E=f,O=m,k=h,j=_,M=v):(S=l,C=c,T=f,E=d,O=h,k=m,j=v,M=_)):b>=x?(w=c,D=d,A=m,N=_,c>=0?(S=l,C=s,T=f,E=u,O=h,k=p,j=v,M=g):(S=s,C=l,T=u,E=f,O=p,k=h,j=g,M=v)):(w=l,D=f,A=h,N=v,l>=0?(S=s,C=c,T=u,E=d,O=p,k=m,j=g,M=_):(S=c,C=s,T=d,E=u,O=m,k=p,j=_,M=g)),w===0)return null;let P=S/w,F=C/w,I=1/w,ee=T-P*D,te=E-F*D,ne=O-P*A,re=k-F*A,ie=j-P*N,ae=M-F*N,L=ie*re-ae*ne,oe=ee*ae-te*ie,R=ne*te-re*ee;if(r){if(L<0||oe<0||R<0)return null}else if((L<0||oe<0||R<0)&&(L>0||oe>0||R>0))return null;let se=L+oe+R;if(se===0)return null;let ce=I*(L*D+oe*A+R*N);return(se>0?ce<0:ce>0)?null:this.at(ce/se,i)}applyMatrix4(e){return this.origin.applyMatrix4(e),this.direction.transformDirection(e),this}equals(e){return e.origin.equals(this.origin)&&e.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},Da=class extends xa{constructor(e){super(),this.isMeshBasicMaterial=!0,this.type=`MeshBasicMaterial`,this.color=new Z(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Yr,this.combine=0,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap=`round`,this.wireframeLinejoin=`round`,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.fog=e.fog,this}},Oa=new zr,ka=new Ea,Aa=new sa,ja=new J,Ma=new J,Na=new J,Pa=new J,Fa=new J,Ia=new J,La=new J,Ra=new J,za=class extends fi{constructor(e=new ha,t=new Da){super(),this.isMesh=!0,this.type=`Mesh`,this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),this.morphTargetInfluences=e.morphTargetInfluences===void 0?void 0:e.morphTargetInfluences.slice(),this.morphTargetDictionary=e.morphTargetDictionary===void 0?void 0:Object.assign({},e.morphTargetDictionary),this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,t=Object.keys(e);if(t.length>0){let n=e[t[0]];if(n!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let e=0,t=n.length;e<t;e++){let t=n[e].name||String(e);this.morphTargetInfluences.push(0),this.morphTargetDictionary[t]=e}}}}getVertexPosition(e,t){let n=this.geometry,r=n.attributes.position,i=n.morphAttributes.position,a=n.morphTargetsRelative;t.fromBufferAttribute(r,e);let o=this.morphTargetInfluences;if(i&&o){Ia.set(0,0,0);for(let n=0,r=i.length;n<r;n++){let r=o[n],s=i[n];r!==0&&(Fa.fromBufferAttribute(s,e),a?Ia.addScaledVector(Fa,r):Ia.addScaledVector(Fa.sub(t),r))}t.add(Ia)}return t}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,r=this.material,i=this.matrixWorld;r!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),Aa.copy(n.boundingSphere),Aa.applyMatrix4(i),ka.copy(e.ray).recast(e.near),Aa.containsPoint(ka.origin)===!1&&(ka.intersectSphere(Aa,ja)===null||ka.origin.distanceToSquared(ja)>(e.far-e.near)**2)||(Oa.copy(i).invert(),ka.copy(e.ray).applyMatrix4(Oa),(n.boundingBox===null||ka.intersectsBox(n.boundingBox)!==!1)&&this._computeIntersections(e,t,ka)))}_computeIntersections(e,t,n){let r,i=this.geometry,a=this.material,o=i.index,s=i.attributes.position,c=i.attributes.uv,l=i.attributes.uv1,u=i.attributes.normal,d=i.groups,f=i.drawRange;if(o!==null){if(Array.isArray(a))for(let i=0,s=d.length;i<s;i++){let s=d[i],p=a[s.materialIndex],m=Math.max(s.start,f.start),h=Math.min(o.count,Math.min(s.start+s.count,f.start+f.count));for(let i=m,a=h;i<a;i+=3){let a=o.getX(i),d=o.getX(i+1),f=o.getX(i+2);r=Va(this,p,e,n,c,l,u,a,d,f),r&&(r.faceIndex=Math.floor(i/3),r.face.materialIndex=s.materialIndex,t.push(r))}}else{let i=Math.max(0,f.start),s=Math.min(o.count,f.start+f.count);for(let d=i,f=s;d<f;d+=3){let i=o.getX(d),s=o.getX(d+1),f=o.getX(d+2);r=Va(this,a,e,n,c,l,u,i,s,f),r&&(r.faceIndex=Math.floor(d/3),t.push(r))}}}else if(s!==void 0){if(Array.isArray(a))for(let i=0,o=d.length;i<o;i++){let o=d[i],p=a[o.materialIndex],m=Math.max(o.start,f.start),h=Math.min(s.count,Math.min(o.start+o.count,f.start+f.count));for(let i=m,a=h;i<a;i+=3){let a=i,s=i+1,d=i+2;r=Va(this,p,e,n,c,l,u,a,s,d),r&&(r.faceIndex=Math.floor(i/3),r.face.materialIndex=o.materialIndex,t.push(r))}}else{let i=Math.max(0,f.start),o=Math.min(s.count,f.start+f.count);for(let s=i,d=o;s<d;s+=3){let i=s,o=s+1,d=s+2;r=Va(this,a,e,n,c,l,u,i,o,d),r&&(r.faceIndex=Math.floor(s/3),t.push(r))}}}}};function Ba(e,t,n,r,i,a,o,s){let c;if(c=t.side===1?r.intersectTriangle(o,a,i,!0,s):r.intersectTriangle(i,a,o,t.side===0,s),c===null)return null;Ra.copy(s),Ra.applyMatrix4(e.matrixWorld);let l=n.ray.origin.distanceTo(Ra);return l<n.near||l>n.far?null:{distance:l,point:Ra.clone(),object:e}}function Va(e,t,n,r,i,a,o,s,c,l){e.getVertexPosition(s,Ma),e.getVertexPosition(c,Na),e.getVertexPosition(l,Pa);let u=Ba(e,t,n,r,Ma,Na,Pa,La);if(u){let e=new J;Fi.getBarycoord(La,Ma,Na,Pa,e),i&&(u.uv=Fi.getInterpolatedAttribute(i,s,c,l,e,new q)),a&&(u.uv1=Fi.getInterpolatedAttribute(a,s,c,l,e,new q)),o&&(u.normal=Fi.getInterpolatedAttribute(o,s,c,l,e,new J),u.normal.dot(r.direction)>0&&u.normal.multiplyScalar(-1));let t={a:s,b:c,c:l,normal:new J,materialIndex:0};Fi.getNormal(Ma,Na,Pa,t.normal),u.face=t,u.barycoord=e}return u}var Ha=class extends Nr{constructor(e=null,t=1,n=1,r,i,a,o,s,c=St,l=St,u,d){super(null,a,o,s,c,l,r,i,u,d),this.isDataTexture=!0,this.image={data:e,width:t,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}},Ua=new sa,Wa=new q(.5,.5),Ga=new J,Ka=class{constructor(e=new ya,t=new ya,n=new ya,r=new ya,i=new ya,a=new ya){this.planes=[e,t,n,r,i,a]}set(e,t,n,r,i,a){let o=this.planes;return o[0].copy(e),o[1].copy(t),o[2].copy(n),o[3].copy(r),o[4].copy(i),o[5].copy(a),this}copy(e){let t=this.planes;for(let n=0;n<6;n++)t[n].copy(e.planes[n]);return this}setFromProjectionMatrix(e,t=Yn,n=!1){let r=this.planes,i=e.elements,a=i[0],o=i[1],s=i[2],c=i[3],l=i[4],u=i[5],d=i[6],f=i[7],p=i[8],m=i[9],h=i[10],g=i[11],_=i[12],v=i[13],y=i[14],b=i[15];if(r[0].setComponents(c-a,f-l,g-p,b-_).normalize(),r[1].setComponents(c+a,f+l,g+p,b+_).normalize(),r[2].setComponents(c+o,f+u,g+m,b+v).normalize(),r[3].setComponents(c-o,f-u,g-m,b-v).normalize(),n)r[4].setComponents(s,d,h,y).normalize(),r[5].setComponents(c-s,f-d,g-h,b-y).normalize();else if(r[4].setComponents(c-s,f-d,g-h,b-y).normalize(),t===2e3)r[5].setComponents(c+s,f+d,g+h,b+y).normalize();else if(t===2001)r[5].setComponents(s,d,h,y).normalize();else throw Error(`THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: `+t);return this}intersectsObject(e){if(e.boundingSphere!==void 0)e.boundingSphere===null&&e.computeBoundingSphere(),Ua.copy(e.boundingSphere).applyMatrix4(e.matrixWorld);else{let t=e.geometry;t.boundingSphere===null&&t.computeBoundingSphere(),Ua.copy(t.boundingSphere).applyMatrix4(e.matrixWorld)}return this.intersectsSphere(Ua)}intersectsSprite(e){return Ua.center.set(0,0,0),Ua.radius=.7071067811865476+Wa.distanceTo(e.center),Ua.applyMatrix4(e.matrixWorld),this.intersectsSphere(Ua)}intersectsSphere(e){let t=this.planes,n=e.center,r=-e.radius;for(let e=0;e<6;e++)if(t[e].distanceToPoint(n)<r)return!1;return!0}intersectsBox(e){let t=this.planes;for(let n=0;n<6;n++){let r=t[n];if(Ga.x=r.normal.x>0?e.max.x:e.min.x,Ga.y=r.normal.y>0?e.max.y:e.min.y,Ga.z=r.normal.z>0?e.max.z:e.min.z,r.distanceToPoint(Ga)<0)return!1}return!0}containsPoint(e){let t=this.planes;for(let n=0;n<6;n++)if(t[n].distanceToPoint(e)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},qa=new zr,Ja=class e{constructor(){this.coordinateSystem=Yn,this._frustums=[],this._count=0}setFromArrayCamera(e){let t=e.cameras,n=this._frustums;for(let e=0;e<t.length;e++){let r=t[e];qa.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[e]===void 0&&(n[e]=new Ka),n[e].setFromProjectionMatrix(qa,r.coordinateSystem,r.reversedDepth)}return this._count=t.length,this}getFrustum(e){return this._frustums[e]}intersectsObject(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsObject(e))return!0;return!1}intersectsSprite(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSprite(e))return!0;return!1}intersectsSphere(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSphere(e))return!0;return!1}intersectsBox(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsBox(e))return!0;return!1}containsPoint(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].containsPoint(e))return!0;return!1}copy(e){this.coordinateSystem=e.coordinateSystem;let t=this._frustums,n=e._frustums;for(let r=0;r<e._count;r++)t[r]===void 0&&(t[r]=new Ka),t[r].copy(n[r]);return this._count=e._count,this}clone(){return new e().copy(this)}},Ya=class extends xa{constructor(e){super(),this.isLineBasicMaterial=!0,this.type=`LineBasicMaterial`,this.color=new Z(16777215),this.map=null,this.linewidth=1,this.linecap=`round`,this.linejoin=`round`,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.linewidth=e.linewidth,this.linecap=e.linecap,this.linejoin=e.linejoin,this.fog=e.fog,this}},Xa=new J,Za=new J,Qa=new zr,$a=new Ea,eo=new sa,to=new J,no=new J,ro=class extends fi{constructor(e=new ha,t=new Ya){super(),this.isLine=!0,this.type=`Line`,this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),this.morphTargetInfluences=e.morphTargetInfluences===void 0?void 0:e.morphTargetInfluences.slice(),this.morphTargetDictionary=e.morphTargetDictionary===void 0?void 0:Object.assign({},e.morphTargetDictionary),this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[0];for(let e=1,r=t.count;e<r;e++)Xa.fromBufferAttribute(t,e-1),Za.fromBufferAttribute(t,e),n[e]=n[e-1],n[e]+=Xa.distanceTo(Za);e.setAttribute(`lineDistance`,new ra(n,1))}else W(`Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.`);return this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,r=this.matrixWorld,i=e.params.Line.threshold,a=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),eo.copy(n.boundingSphere),eo.applyMatrix4(r),eo.radius+=i,e.ray.intersectsSphere(eo)===!1)return;Qa.copy(r).invert(),$a.copy(e.ray).applyMatrix4(Qa);let o=i/((this.scale.x+this.scale.y+this.scale.z)/3),s=o*o,c=this.isLineSegments?2:1,l=n.index,u=n.attributes.position;if(l!==null){let n=Math.max(0,a.start),r=Math.min(l.count,a.start+a.count);for(let i=n,a=r-1;i<a;i+=c){let n=l.getX(i),r=l.getX(i+1),a=io(this,e,$a,s,n,r,i);a&&t.push(a)}if(this.isLineLoop){let i=l.getX(r-1),a=l.getX(n),o=io(this,e,$a,s,i,a,r-1);o&&t.push(o)}}else{let n=Math.max(0,a.start),r=Math.min(u.count,a.start+a.count);for(let i=n,a=r-1;i<a;i+=c){let n=io(this,e,$a,s,i,i+1,i);n&&t.push(n)}if(this.isLineLoop){let i=io(this,e,$a,s,r-1,n,r-1);i&&t.push(i)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,t=Object.keys(e);if(t.length>0){let n=e[t[0]];if(n!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let e=0,t=n.length;e<t;e++){let t=n[e].name||String(e);this.morphTargetInfluences.push(0),this.morphTargetDictionary[t]=e}}}}};function io(e,t,n,r,i,a,o){let s=e.geometry.attributes.position;if(Xa.fromBufferAttribute(s,i),Za.fromBufferAttribute(s,a),n.distanceSqToSegment(Xa,Za,to,no)>r)return;to.applyMatrix4(e.matrixWorld);let c=t.ray.origin.distanceTo(to);if(!(c<t.near||c>t.far))return{distance:c,point:no.clone().applyMatrix4(e.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:e}}var ao=new J,oo=new J,so=class extends ro{constructor(e,t){super(e,t),this.isLineSegments=!0,this.type=`LineSegments`}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[];for(let e=0,r=t.count;e<r;e+=2)ao.fromBufferAttribute(t,e),oo.fromBufferAttribute(t,e+1),n[e]=e===0?0:n[e-1],n[e+1]=n[e]+ao.distanceTo(oo);e.setAttribute(`lineDistance`,new ra(n,1))}else W(`LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.`);return this}},co=class extends xa{constructor(e){super(),this.isPointsMaterial=!0,this.type=`PointsMaterial`,this.color=new Z(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.alphaMap=e.alphaMap,this.size=e.size,this.sizeAttenuation=e.sizeAttenuation,this.fog=e.fog,this}},lo=new zr,uo=new Ea,fo=new sa,po=new J,mo=class extends fi{constructor(e=new ha,t=new co){super(),this.isPoints=!0,this.type=`Points`,this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),this.morphTargetInfluences=e.morphTargetInfluences===void 0?void 0:e.morphTargetInfluences.slice(),this.morphTargetDictionary=e.morphTargetDictionary===void 0?void 0:Object.assign({},e.morphTargetDictionary),this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,r=this.matrixWorld,i=e.params.Points.threshold,a=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),fo.copy(n.boundingSphere),fo.applyMatrix4(r),fo.radius+=i,e.ray.intersectsSphere(fo)===!1)return;lo.copy(r).invert(),uo.copy(e.ray).applyMatrix4(lo);let o=i/((this.scale.x+this.scale.y+this.scale.z)/3),s=o*o,c=n.index,l=n.attributes.position;if(c!==null){let n=Math.max(0,a.start),i=Math.min(c.count,a.start+a.count);for(let a=n,o=i;a<o;a++){let n=c.getX(a);po.fromBufferAttribute(l,n),ho(po,n,s,r,e,t,this)}}else{let n=Math.max(0,a.start),i=Math.min(l.count,a.start+a.count);for(let a=n,o=i;a<o;a++)po.fromBufferAttribute(l,a),ho(po,a,s,r,e,t,this)}}updateMorphTargets(){let e=this.geometry.morphAttributes,t=Object.keys(e);if(t.length>0){let n=e[t[0]];if(n!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let e=0,t=n.length;e<t;e++){let t=n[e].name||String(e);this.morphTargetInfluences.push(0),this.morphTargetDictionary[t]=e}}}}};function ho(e,t,n,r,i,a,o){let s=uo.distanceSqToPoint(e);if(s<n){let n=new J;uo.closestPointToPoint(e,n),n.applyMatrix4(r);let c=i.ray.origin.distanceTo(n);if(c<i.near||c>i.far)return;a.push({distance:c,distanceToRay:Math.sqrt(s),point:n,index:t,face:null,faceIndex:null,barycoord:null,object:o})}}var go=class extends Nr{constructor(e=[],t=301,n,r,i,a,o,s,c,l){super(e,t,n,r,i,a,o,s,c,l),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(e){this.image=e}},_o=class extends Nr{constructor(e,t,n=Nt,r,i,a,o=St,s=St,c,l=Wt,u=1){if(l!==1026&&l!==1027)throw Error(`THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat`);super({width:e,height:t,depth:u},r,i,a,o,s,l,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(e){return super.copy(e),this.source=new kr(Object.assign({},e.image)),this.compareFunction=e.compareFunction,this}toJSON(e){let t=super.toJSON(e);return t.compareFunction=this.compareFunction,t}},vo=class extends _o{constructor(e,t=Nt,n=301,r,i,a=St,o=St,s,c=Wt){let l={width:e,height:e,depth:1},u=[l,l,l,l,l,l];super(e,e,t,n,r,i,a,o,s,c),this.image=u,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(e){this.image=e}},yo=class extends Nr{constructor(e=null){super(),this.sourceTexture=e,this.isExternalTexture=!0}copy(e){return super.copy(e),this.sourceTexture=e.sourceTexture,this}},bo=class e extends ha{constructor(e=1,t=1,n=1,r=1,i=1,a=1){super(),this.type=`BoxGeometry`,this.parameters={width:e,height:t,depth:n,widthSegments:r,heightSegments:i,depthSegments:a};let o=this;r=Math.floor(r),i=Math.floor(i),a=Math.floor(a);let s=[],c=[],l=[],u=[],d=0,f=0;p(`z`,`y`,`x`,-1,-1,n,t,e,a,i,0),p(`z`,`y`,`x`,1,-1,n,t,-e,a,i,1),p(`x`,`z`,`y`,1,1,e,n,t,r,a,2),p(`x`,`z`,`y`,1,-1,e,n,-t,r,a,3),p(`x`,`y`,`z`,1,-1,e,t,n,r,i,4),p(`x`,`y`,`z`,-1,-1,e,t,-n,r,i,5),this.setIndex(s),this.setAttribute(`position`,new ra(c,3)),this.setAttribute(`normal`,new ra(l,3)),this.setAttribute(`uv`,new ra(u,2));function p(e,t,n,r,i,a,p,m,h,g,_){let v=a/h,y=p/g,b=a/2,x=p/2,S=m/2,C=h+1,w=g+1,T=0,E=0,D=new J;for(let a=0;a<w;a++){let o=a*y-x;for(let s=0;s<C;s++)D[e]=(s*v-b)*r,D[t]=o*i,D[n]=S,c.push(D.x,D.y,D.z),D[e]=0,D[t]=0,D[n]=m>0?1:-1,l.push(D.x,D.y,D.z),u.push(s/h),u.push(1-a/g),T+=1}for(let e=0;e<g;e++)for(let t=0;t<h;t++){let n=d+t+C*e,r=d+t+C*(e+1),i=d+(t+1)+C*(e+1),a=d+(t+1)+C*e;s.push(n,r,a),s.push(r,i,a),E+=6}o.addGroup(f,E,_),f+=E,d+=T}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(t){return new e(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}},xo=class e extends ha{constructor(e=1,t=1,n=1,r=1){super(),this.type=`PlaneGeometry`,this.parameters={width:e,height:t,widthSegments:n,heightSegments:r};let i=e/2,a=t/2,o=Math.floor(n),s=Math.floor(r),c=o+1,l=s+1,u=e/o,d=t/s,f=[],p=[],m=[],h=[];for(let e=0;e<l;e++){let t=e*d-a;for(let n=0;n<c;n++){let r=n*u-i;p.push(r,-t,0),m.push(0,0,1),h.push(n/o),h.push(1-e/s)}}for(let e=0;e<s;e++)for(let t=0;t<o;t++){let n=t+c*e,r=t+c*(e+1),i=t+1+c*(e+1),a=t+1+c*e;f.push(n,r,a),f.push(r,i,a)}this.setIndex(f),this.setAttribute(`position`,new ra(p,3)),this.setAttribute(`normal`,new ra(m,3)),this.setAttribute(`uv`,new ra(h,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(t){return new e(t.width,t.height,t.widthSegments,t.heightSegments)}};function So(e){let t={};for(let n in e){t[n]={};for(let r in e[n]){let i=e[n][r];if(wo(i))i.isRenderTargetTexture?(W(`UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms().`),t[n][r]=null):t[n][r]=i.clone();else if(Array.isArray(i)){if(wo(i[0])){let e=[];for(let t=0,n=i.length;t<n;t++)e[t]=i[t].clone();t[n][r]=e}else t[n][r]=i.slice()}else t[n][r]=i}}return t}function Co(e){let t={};for(let n=0;n<e.length;n++){let r=So(e[n]);for(let e in r)t[e]=r[e]}return t}function wo(e){return e&&(e.isColor||e.isMatrix3||e.isMatrix4||e.isVector2||e.isVector3||e.isVector4||e.isTexture||e.isQuaternion)}function To(e){let t=[];for(let n=0;n<e.length;n++)t.push(e[n].clone());return t}function Eo(e){let t=e.getRenderTarget();return t===null?e.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:X.workingColorSpace}var Do={clone:So,merge:Co},Oo=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,ko=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Ao=class extends xa{constructor(e){super(),this.isShaderMaterial=!0,this.type=`ShaderMaterial`,this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=Oo,this.fragmentShader=ko,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,e!==void 0&&this.setValues(e)}copy(e){return super.copy(e),this.fragmentShader=e.fragmentShader,this.vertexShader=e.vertexShader,this.uniforms=So(e.uniforms),this.uniformsGroups=To(e.uniformsGroups),this.defines=Object.assign({},e.defines),this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.fog=e.fog,this.lights=e.lights,this.clipping=e.clipping,this.extensions=Object.assign({},e.extensions),this.glslVersion=e.glslVersion,this.defaultAttributeValues=Object.assign({},e.defaultAttributeValues),this.index0AttributeName=e.index0AttributeName,this.uniformsNeedUpdate=e.uniformsNeedUpdate,this}toJSON(e){let t=super.toJSON(e);t.glslVersion=this.glslVersion,t.uniforms={};for(let n in this.uniforms){let r=this.uniforms[n].value;r&&r.isTexture?t.uniforms[n]={type:`t`,value:r.toJSON(e).uuid}:r&&r.isColor?t.uniforms[n]={type:`c`,value:r.getHex()}:r&&r.isVector2?t.uniforms[n]={type:`v2`,value:r.toArray()}:r&&r.isVector3?t.uniforms[n]={type:`v3`,value:r.toArray()}:r&&r.isVector4?t.uniforms[n]={type:`v4`,value:r.toArray()}:r&&r.isMatrix3?t.uniforms[n]={type:`m3`,value:r.toArray()}:r&&r.isMatrix4?t.uniforms[n]={type:`m4`,value:r.toArray()}:t.uniforms[n]={value:r}}Object.keys(this.defines).length>0&&(t.defines=this.defines),t.vertexShader=this.vertexShader,t.fragmentShader=this.fragmentShader,t.lights=this.lights,t.clipping=this.clipping;let n={};for(let e in this.extensions)this.extensions[e]===!0&&(n[e]=!0);return Object.keys(n).length>0&&(t.extensions=n),t}fromJSON(e,t){if(super.fromJSON(e,t),e.uniforms!==void 0)for(let n in e.uniforms){let r=e.uniforms[n];switch(this.uniforms[n]={},r.type){case`t`:this.uniforms[n].value=t[r.value]||null;break;case`c`:this.uniforms[n].value=new Z().setHex(r.value);break;case`v2`:this.uniforms[n].value=new q().fromArray(r.value);break;case`v3`:this.uniforms[n].value=new J().fromArray(r.value);break;case`v4`:this.uniforms[n].value=new Pr().fromArray(r.value);break;case`m3`:this.uniforms[n].value=new Y().fromArray(r.value);break;case`m4`:this.uniforms[n].value=new zr().fromArray(r.value);break;default:this.uniforms[n].value=r.value}}if(e.defines!==void 0&&(this.defines=e.defines),e.vertexShader!==void 0&&(this.vertexShader=e.vertexShader),e.fragmentShader!==void 0&&(this.fragmentShader=e.fragmentShader),e.glslVersion!==void 0&&(this.glslVersion=e.glslVersion),e.extensions!==void 0)for(let t in e.extensions)this.extensions[t]=e.extensions[t];return e.lights!==void 0&&(this.lights=e.lights),e.clipping!==void 0&&(this.clipping=e.clipping),this}},jo=class extends Ao{constructor(e){super(e),this.isRawShaderMaterial=!0,this.type=`RawShaderMaterial`}},Mo=class extends xa{constructor(e){super(),this.isMeshDepthMaterial=!0,this.type=`MeshDepthMaterial`,this.depthPacking=Vn,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(e)}copy(e){return super.copy(e),this.depthPacking=e.depthPacking,this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this}},No=class extends xa{constructor(e){super(),this.isMeshDistanceMaterial=!0,this.type=`MeshDistanceMaterial`,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(e)}copy(e){return super.copy(e),this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this}};function Po(e,t){return!e||e.constructor===t?e:typeof t.BYTES_PER_ELEMENT==`number`?new t(e):Array.prototype.slice.call(e)}function Fo(e){return e!==void 0&&e.inTangents!==void 0&&e.outTangents!==void 0}var Io=class{constructor(e,t,n,r){this.parameterPositions=e,this._cachedIndex=0,this.resultBuffer=r===void 0?new t.constructor(n):r,this.sampleValues=t,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(e){let t=this.parameterPositions,n=this._cachedIndex,r=t[n],i=t[n-1];validate_interval:{seek:{let a;linear_scan:{forward_scan:if(!(e<r)){for(let a=n+2;;){if(r===void 0){if(e<i)break forward_scan;return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(i=r,r=t[++n],e<r)break seek}a=t.length;break linear_scan}if(!(e>=i)){let o=t[1];e<o&&(n=2,i=o);for(let a=n-2;;){if(i===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===a)break;if(r=i,i=t[--n-1],e>=i)break seek}a=n,n=0;break linear_scan}break validate_interval}for(;n<a;){let r=n+a>>>1;e<t[r]?a=r:n=r+1}if(r=t[n],i=t[n-1],i===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(r===void 0)return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,i,r)}return this.interpolate_(n,i,e,r)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(e){let t=this.resultBuffer,n=this.sampleValues,r=this.valueSize,i=e*r;for(let e=0;e!==r;++e)t[e]=n[i+e];return t}interpolate_(){throw Error(`THREE.Interpolant: Call to abstract method.`)}intervalChanged_(){}},Lo=class extends Io{constructor(e,t,n,r){super(e,t,n,r),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Rn,endingEnd:Rn}}intervalChanged_(e,t,n){let r=this.parameterPositions,i=e-2,a=e+1,o=r[i],s=r[a];if(o===void 0)switch(this.getSettings_().endingStart){case zn:i=e,o=2*t-n;break;case Bn:i=r.length-2,o=t+r[i]-r[i+1];break;default:i=e,o=n}if(s===void 0)switch(this.getSettings_().endingEnd){case zn:a=e,s=2*n-t;break;case Bn:a=1,s=n+r[1]-r[0];break;default:a=e-1,s=t}let c=(n-t)*.5,l=this.valueSize;this._weightPrev=c/(t-o),this._weightNext=c/(s-n),this._offsetPrev=i*l,this._offsetNext=a*l}interpolate_(e,t,n,r){let i=this.resultBuffer,a=this.sampleValues,o=this.valueSize,s=e*o,c=s-o,l=this._offsetPrev,u=this._offsetNext,d=this._weightPrev,f=this._weightNext,p=(n-t)/(r-t),m=p*p,h=m*p,g=-d*h+2*d*m-d*p,_=(1+d)*h+(-1.5-2*d)*m+(-.5+d)*p+1,v=(-1-f)*h+(1.5+f)*m+.5*p,y=f*h-f*m;for(let e=0;e!==o;++e)i[e]=g*a[l+e]+_*a[c+e]+v*a[s+e]+y*a[u+e];return i}},Ro=class extends Io{constructor(e,t,n,r){super(e,t,n,r)}interpolate_(e,t,n,r){let i=this.resultBuffer,a=this.sampleValues,o=this.valueSize,s=e*o,c=s-o,l=(n-t)/(r-t),u=1-l;for(let e=0;e!==o;++e)i[e]=a[c+e]*u+a[s+e]*l;return i}},zo=class extends Io{constructor(e,t,n,r){super(e,t,n,r)}interpolate_(e){return this.copySampleValue_(e-1)}},Bo=class extends Io{interpolate_(e,t,n,r){let i=this.resultBuffer,a=this.sampleValues,o=this.valueSize,s=e*o,c=s-o,l=this.inTangents,u=this.outTangents;if(!l||!u){let e=(n-t)/(r-t),l=1-e;for(let t=0;t!==o;++t)i[t]=a[c+t]*l+a[s+t]*e;return i}let d=o*2,f=e-1;for(let p=0;p!==o;++p){let o=a[c+p],m=a[s+p],h=f*d+p*2,g=u[h],_=u[h+1],v=e*d+p*2,y=l[v],b=l[v+1],x=Uo(n,t,g,y,r);i[p]=Vo(x,o,_,b,m)}return i}};function Vo(e,t,n,r,i){let a=1-e;return a*a*a*t+3*a*a*e*n+3*a*e*e*r+e*e*e*i}function Ho(e,t,n,r,i){let a=1-e;return 3*a*a*(n-t)+6*a*e*(r-n)+3*e*e*(i-r)}function Uo(e,t,n,r,i){let a=(e-t)/(i-t);for(let o=0;o<8;o++){let o=Vo(a,t,n,r,i)-e;if(Math.abs(o)<1e-10)break;let s=Ho(a,t,n,r,i);if(Math.abs(s)<1e-10)break;a=Math.max(0,Math.min(1,a-o/s))}return a}var Wo=class{constructor(e,t,n,r){if(e===void 0)throw Error(`THREE.KeyframeTrack: track name is undefined`);if(t===void 0||t.length===0)throw Error(`THREE.KeyframeTrack: no keyframes in track named `+e);this.name=e,this.times=Po(t,this.TimeBufferType),this.values=Po(n,this.ValueBufferType),this.setInterpolation(r||this.DefaultInterpolation)}static toJSON(e){let t=e.constructor,n;if(t.toJSON!==this.toJSON)n=t.toJSON(e);else{n={name:e.name,times:Po(e.times,Array),values:Po(e.values,Array)};let t=e.getInterpolation();t!==e.DefaultInterpolation&&(n.interpolation=t),Fo(e.settings)&&(n.settings={inTangents:Po(e.settings.inTangents,Array),outTangents:Po(e.settings.outTangents,Array)})}return n.type=e.ValueTypeName,n}InterpolantFactoryMethodDiscrete(e){return new zo(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodLinear(e){return new Ro(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodSmooth(e){return new Lo(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodBezier(e){let t=new Bo(this.times,this.values,this.getValueSize(),e);return this.settings&&(t.inTangents=this.settings.inTangents,t.outTangents=this.settings.outTangents),t}setInterpolation(e){let t;switch(e){case Pn:t=this.InterpolantFactoryMethodDiscrete;break;case Fn:t=this.InterpolantFactoryMethodLinear;break;case In:t=this.InterpolantFactoryMethodSmooth;break;case Ln:t=this.InterpolantFactoryMethodBezier}if(t===void 0){let t=`unsupported interpolation for `+this.ValueTypeName+` keyframe track named `+this.name;if(this.createInterpolant===void 0){if(e!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw Error(t)}return W(`KeyframeTrack:`,t),this}return this.createInterpolant=t,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return Pn;case this.InterpolantFactoryMethodLinear:return Fn;case this.InterpolantFactoryMethodSmooth:return In;case this.InterpolantFactoryMethodBezier:return Ln}}getValueSize(){return this.values.length/this.times.length}shift(e){if(e!==0){let t=this.times;for(let n=0,r=t.length;n!==r;++n)t[n]+=e;Fo(this.settings)&&(Go(this.settings.inTangents,e),Go(this.settings.outTangents,e))}return this}scale(e){if(e!==1){let t=this.times;for(let n=0,r=t.length;n!==r;++n)t[n]*=e;Fo(this.settings)&&(Ko(this.settings.inTangents,e),Ko(this.settings.outTangents,e))}return this}trim(e,t){let n=this.times,r=n.length,i=0,a=r-1;for(;i!==r&&n[i]<e;)++i;for(;a!==-1&&n[a]>t;)--a;if(++a,i!==0||a!==r){i>=a&&(a=Math.max(a,1),i=a-1);let e=this.getValueSize();this.times=n.slice(i,a),this.values=this.values.slice(i*e,a*e)}return this}validate(){let e=!0,t=this.getValueSize();t-Math.floor(t)!==0&&(G(`KeyframeTrack: Invalid value size in track.`,this),e=!1);let n=this.times,r=this.values,i=n.length;i===0&&(G(`KeyframeTrack: Track is empty.`,this),e=!1);let a=null;for(let t=0;t!==i;t++){let r=n[t];if(typeof r==`number`&&isNaN(r)){G(`KeyframeTrack: Time is not a valid number.`,this,t,r),e=!1;break}if(a!==null&&a>r){G(`KeyframeTrack: Out of order keys.`,this,t,r,a),e=!1;break}a=r}if(r!==void 0&&Zn(r))for(let t=0,n=r.length;t!==n;++t){let n=r[t];if(isNaN(n)){G(`KeyframeTrack: Value is not a valid number.`,this,t,n),e=!1;break}}return e}optimize(){let e=this.times.slice(),t=this.values.slice(),n=this.getValueSize(),r=this.getInterpolation()===In,i=e.length-1,a=1;for(let o=1;o<i;++o){let i=!1,s=e[o];if(s!==e[o+1]&&(o!==1||s!==e[0])){if(r)i=!0;else{let e=o*n,r=e-n,a=e+n;for(let o=0;o!==n;++o){let n=t[e+o];if(n!==t[r+o]||n!==t[a+o]){i=!0;break}}}}if(i){if(o!==a){e[a]=e[o];let r=o*n,i=a*n;for(let e=0;e!==n;++e)t[i+e]=t[r+e]}++a}}if(i>0){e[a]=e[i];for(let e=i*n,r=a*n,o=0;o!==n;++o)t[r+o]=t[e+o];++a}return a===e.length?(this.times=e,this.values=t):(this.times=e.slice(0,a),this.values=t.slice(0,a*n)),this}clone(){let e=this.times.slice(),t=this.values.slice(),n=this.constructor,r=new n(this.name,e,t);return r.createInterpolant=this.createInterpolant,Fo(this.settings)&&(r.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),r}};function Go(e,t){for(let n=0,r=e.length;n!==r;n+=2)e[n]+=t}function Ko(e,t){for(let n=0,r=e.length;n!==r;n+=2)e[n]*=t}Wo.prototype.ValueTypeName=``,Wo.prototype.TimeBufferType=Float32Array,Wo.prototype.ValueBufferType=Float32Array,Wo.prototype.DefaultInterpolation=Fn;var qo=class extends Wo{constructor(e,t,n){super(e,t,n)}};qo.prototype.ValueTypeName=`bool`,qo.prototype.ValueBufferType=Array,qo.prototype.DefaultInterpolation=Pn,qo.prototype.InterpolantFactoryMethodLinear=void 0,qo.prototype.InterpolantFactoryMethodSmooth=void 0;var Jo=class extends Wo{constructor(e,t,n,r){super(e,t,n,r)}};Jo.prototype.ValueTypeName=`color`;var Yo=class extends Wo{constructor(e,t,n,r){super(e,t,n,r)}};Yo.prototype.ValueTypeName=`number`;var Xo=class extends Io{constructor(e,t,n,r){super(e,t,n,r)}interpolate_(e,t,n,r){let i=this.resultBuffer,a=this.sampleValues,o=this.valueSize,s=(n-t)/(r-t),c=e*o;for(let e=c+o;c!==e;c+=4)_r.slerpFlat(i,0,a,c-o,a,c,s);return i}},Zo=class extends Wo{constructor(e,t,n,r){super(e,t,n,r)}InterpolantFactoryMethodLinear(e){return new Xo(this.times,this.values,this.getValueSize(),e)}};Zo.prototype.ValueTypeName=`quaternion`,Zo.prototype.InterpolantFactoryMethodSmooth=void 0;var Qo=class extends Wo{constructor(e,t,n){super(e,t,n)}};Qo.prototype.ValueTypeName=`string`,Qo.prototype.ValueBufferType=Array,Qo.prototype.DefaultInterpolation=Pn,Qo.prototype.InterpolantFactoryMethodLinear=void 0,Qo.prototype.InterpolantFactoryMethodSmooth=void 0;var $o=class extends Wo{constructor(e,t,n,r){super(e,t,n,r)}};$o.prototype.ValueTypeName=`vector`;var es=new J,ts=new _r,ns=new J,rs=class extends fi{constructor(){super(),this.isCamera=!0,this.type=`Camera`,this.matrixWorldInverse=new zr,this.projectionMatrix=new zr,this.projectionMatrixInverse=new zr,this.coordinateSystem=Yn,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(e,t){return super.copy(e,t),this.matrixWorldInverse.copy(e.matrixWorldInverse),this.projectionMatrix.copy(e.projectionMatrix),this.projectionMatrixInverse.copy(e.projectionMatrixInverse),this.coordinateSystem=e.coordinateSystem,this}getWorldDirection(e){return super.getWorldDirection(e).negate()}updateMatrixWorld(e){super.updateMatrixWorld(e),this.matrixWorld.decompose(es,ts,ns),ns.x===1&&ns.y===1&&ns.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(es,ts,ns.set(1,1,1)).invert()}updateWorldMatrix(e,t,n=!1){super.updateWorldMatrix(e,t,n),this.matrixWorld.decompose(es,ts,ns),ns.x===1&&ns.y===1&&ns.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(es,ts,ns.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},is=new J,as=new q,os=new q,ss=class extends rs{constructor(e=50,t=1,n=.1,r=2e3){super(),this.isPerspectiveCamera=!0,this.type=`PerspectiveCamera`,this.fov=e,this.zoom=1,this.near=n,this.far=r,this.focus=10,this.aspect=t,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.fov=e.fov,this.zoom=e.zoom,this.near=e.near,this.far=e.far,this.focus=e.focus,this.aspect=e.aspect,this.view=e.view===null?null:Object.assign({},e.view),this.filmGauge=e.filmGauge,this.filmOffset=e.filmOffset,this}setFocalLength(e){let t=.5*this.getFilmHeight()/e;this.fov=lr*2*Math.atan(t),this.updateProjectionMatrix()}getFocalLength(){let e=Math.tan(cr*.5*this.fov);return .5*this.getFilmHeight()/e}getEffectiveFOV(){return lr*2*Math.atan(Math.tan(cr*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(e,t,n){is.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),t.set(is.x,is.y).multiplyScalar(-e/is.z),is.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(is.x,is.y).multiplyScalar(-e/is.z)}getViewSize(e,t){return this.getViewBounds(e,as,os),t.subVectors(os,as)}setViewOffset(e,t,n,r,i,a){this.aspect=e/t,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=r,this.view.width=i,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=this.near,t=e*Math.tan(cr*.5*this.fov)/this.zoom,n=2*t,r=this.aspect*n,i=-.5*r,a=this.view;if(this.view!==null&&this.view.enabled){let e=a.fullWidth,o=a.fullHeight;i+=a.offsetX*r/e,t-=a.offsetY*n/o,r*=a.width/e,n*=a.height/o}let o=this.filmOffset;o!==0&&(i+=e*o/this.getFilmWidth()),this.projectionMatrix.makePerspective(i,i+r,t,t-n,e,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.fov=this.fov,t.object.zoom=this.zoom,t.object.near=this.near,t.object.far=this.far,t.object.focus=this.focus,t.object.aspect=this.aspect,this.view!==null&&(t.object.view=Object.assign({},this.view)),t.object.filmGauge=this.filmGauge,t.object.filmOffset=this.filmOffset,t}},cs=class extends rs{constructor(e=-1,t=1,n=1,r=-1,i=.1,a=2e3){super(),this.isOrthographicCamera=!0,this.type=`OrthographicCamera`,this.zoom=1,this.view=null,this.left=e,this.right=t,this.top=n,this.bottom=r,this.near=i,this.far=a,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.left=e.left,this.right=e.right,this.top=e.top,this.bottom=e.bottom,this.near=e.near,this.far=e.far,this.zoom=e.zoom,this.view=e.view===null?null:Object.assign({},e.view),this}setViewOffset(e,t,n,r,i,a){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=r,this.view.width=i,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=(this.right-this.left)/(2*this.zoom),t=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,r=(this.top+this.bottom)/2,i=n-e,a=n+e,o=r+t,s=r-t;if(this.view!==null&&this.view.enabled){let e=(this.right-this.left)/this.view.fullWidth/this.zoom,t=(this.top-this.bottom)/this.view.fullHeight/this.zoom;i+=e*this.view.offsetX,a=i+e*this.view.width,o-=t*this.view.offsetY,s=o-t*this.view.height}this.projectionMatrix.makeOrthographic(i,a,o,s,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.zoom=this.zoom,t.object.left=this.left,t.object.right=this.right,t.object.top=this.top,t.object.bottom=this.bottom,t.object.near=this.near,t.object.far=this.far,this.view!==null&&(t.object.view=Object.assign({},this.view)),t}},ls=-90,us=1,ds=class extends fi{constructor(e,t,n){super(),this.type=`CubeCamera`,this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let r=new ss(ls,us,e,t);r.layers=this.layers,this.add(r);let i=new ss(ls,us,e,t);i.layers=this.layers,this.add(i);let a=new ss(ls,us,e,t);a.layers=this.layers,this.add(a);let o=new ss(ls,us,e,t);o.layers=this.layers,this.add(o);let s=new ss(ls,us,e,t);s.layers=this.layers,this.add(s);let c=new ss(ls,us,e,t);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let e=this.coordinateSystem,t=this.children.concat(),[n,r,i,a,o,s]=t;for(let e of t)this.remove(e);if(e===2e3)n.up.set(0,1,0),n.lookAt(1,0,0),r.up.set(0,1,0),r.lookAt(-1,0,0),i.up.set(0,0,-1),i.lookAt(0,1,0),a.up.set(0,0,1),a.lookAt(0,-1,0),o.up.set(0,1,0),o.lookAt(0,0,1),s.up.set(0,1,0),s.lookAt(0,0,-1);else if(e===2001)n.up.set(0,-1,0),n.lookAt(-1,0,0),r.up.set(0,-1,0),r.lookAt(1,0,0),i.up.set(0,0,1),i.lookAt(0,1,0),a.up.set(0,0,-1),a.lookAt(0,-1,0),o.up.set(0,-1,0),o.lookAt(0,0,1),s.up.set(0,-1,0),s.lookAt(0,0,-1);else throw Error(`THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: `+e);for(let e of t)this.add(e),e.updateMatrixWorld()}update(e,t){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:r}=this;this.coordinateSystem!==e.coordinateSystem&&(this.coordinateSystem=e.coordinateSystem,this.updateCoordinateSystem());let[i,a,o,s,c,l]=this.children,u=e.getRenderTarget(),d=e.getActiveCubeFace(),f=e.getActiveMipmapLevel(),p=e.xr.enabled;e.xr.enabled=!1;let m=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let h=!1;h=e.isWebGLRenderer===!0?e.state.buffers.depth.getReversed():e.reversedDepthBuffer,e.setRenderTarget(n,0,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,i),e.setRenderTarget(n,1,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,a),e.setRenderTarget(n,2,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,o),e.setRenderTarget(n,3,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,s),e.setRenderTarget(n,4,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,c),n.texture.mipmapsAutoUpdate=m,e.setRenderTarget(n,5,r),h&&e.autoClear===!1&&e.clearDepth(),e.render(t,l),e.setRenderTarget(u,d,f),e.xr.enabled=p,n.texture.needsPMREMUpdate=!0}},fs=class extends ss{constructor(e=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=e,this.perCameraFrustumCulled=!1}},ps=`\\[\\]\\.:\\/`,ms=RegExp(`[\\[\\]\\.:\\/]`,`g`),hs=`[^\\[\\]\\.:\\/]`,gs=`[^`+ps.replace(`\\.`,``)+`]`,_s=`((?:WC+[\\/:])*)`.replace(`WC`,hs),vs=`(WCOD+)?`.replace(`WCOD`,gs),ys=`(?:\\.(WC+)(?:\\[(.+)\\])?)?`.replace(`WC`,hs),bs=`\\.(WC+)(?:\\[(.+)\\])?`.replace(`WC`,hs),xs=RegExp(`^`+_s+vs+ys+bs+`$`),Ss=[`material`,`materials`,`bones`,`map`],Cs=class{constructor(e,t,n){let r=n||ws.parseTrackName(t);this._targetGroup=e,this._bindings=e.subscribe_(t,r)}getValue(e,t){this.bind();let n=this._targetGroup.nCachedObjects_,r=this._bindings[n];r!==void 0&&r.getValue(e,t)}setValue(e,t){let n=this._bindings;for(let r=this._targetGroup.nCachedObjects_,i=n.length;r!==i;++r)n[r].setValue(e,t)}bind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].bind()}unbind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].unbind()}},ws=class e{constructor(t,n,r){this.path=n,this.parsedPath=r||e.parseTrackName(n),this.node=e.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,n,r){return t&&t.isAnimationObjectGroup?new e.Composite(t,n,r):new e(t,n,r)}static sanitizeNodeName(e){return e.replace(/\s/g,`_`).replace(ms,``)}static parseTrackName(e){let t=xs.exec(e);if(t===null)throw Error(`THREE.PropertyBinding: Cannot parse trackName: `+e);let n={nodeName:t[2],objectName:t[3],objectIndex:t[4],propertyName:t[5],propertyIndex:t[6]},r=n.nodeName&&n.nodeName.lastIndexOf(`.`);if(r!==void 0&&r!==-1){let e=n.nodeName.substring(r+1);Ss.indexOf(e)!==-1&&(n.nodeName=n.nodeName.substring(0,r),n.objectName=e)}if(n.propertyName===null||n.propertyName.length===0)throw Error(`THREE.PropertyBinding: can not parse propertyName from trackName: `+e);return n}static findNode(e,t){if(t===void 0||t===``||t===`.`||t===-1||t===e.name||t===e.uuid)return e;if(e.skeleton){let n=e.skeleton.getBoneByName(t);if(n!==void 0)return n}if(e.children){let n=function(e){for(let r=0;r<e.length;r++){let i=e[r];if(i.name===t||i.uuid===t)return i;let a=n(i.children);if(a)return a}return null},r=n(e.children);if(r)return r}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(e,t){e[t]=this.targetObject[this.propertyName]}_getValue_array(e,t){let n=this.resolvedProperty;for(let r=0,i=n.length;r!==i;++r)e[t++]=n[r]}_getValue_arrayElement(e,t){e[t]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(e,t){this.resolvedProperty.toArray(e,t)}_setValue_direct(e,t){this.targetObject[this.propertyName]=e[t]}_setValue_direct_setNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(e,t){let n=this.resolvedProperty;for(let r=0,i=n.length;r!==i;++r)n[r]=e[t++]}_setValue_array_setNeedsUpdate(e,t){let n=this.resolvedProperty;for(let r=0,i=n.length;r!==i;++r)n[r]=e[t++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(e,t){let n=this.resolvedProperty;for(let r=0,i=n.length;r!==i;++r)n[r]=e[t++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(e,t){this.resolvedProperty[this.propertyIndex]=e[t]}_setValue_arrayElement_setNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(e,t){this.resolvedProperty.fromArray(e,t)}_setValue_fromArray_setNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(e,t){this.bind(),this.getValue(e,t)}_setValue_unbound(e,t){this.bind(),this.setValue(e,t)}bind(){let t=this.node,n=this.parsedPath,r=n.objectName,i=n.propertyName,a=n.propertyIndex;if(t||(t=e.findNode(this.rootNode,n.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){W(`PropertyBinding: No target node found for track: `+this.path+`.`);return}if(r){let e=n.objectIndex;switch(r){case`materials`:if(!t.material){G(`PropertyBinding: Can not bind to material as node does not have a material.`,this);return}if(!t.material.materials){G(`PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.`,this);return}t=t.material.materials;break;case`bones`:if(!t.skeleton){G(`PropertyBinding: Can not bind to bones as node does not have a skeleton.`,this);return}t=t.skeleton.bones;for(let n=0;n<t.length;n++)if(t[n].name===e){e=n;break}break;case`map`:if(`map`in t){t=t.map;break}if(!t.material){G(`PropertyBinding: Can not bind to material as node does not have a material.`,this);return}if(!t.material.map){G(`PropertyBinding: Can not bind to material.map as node.material does not have a map.`,this);return}t=t.material.map;break;default:if(t[r]===void 0){G(`PropertyBinding: Can not bind to objectName of node undefined.`,this);return}t=t[r]}if(e!==void 0){if(t[e]===void 0){G(`PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.`,this,t);return}t=t[e]}}let o=t[i];if(o===void 0){let e=n.nodeName;G(`PropertyBinding: Trying to update property for track: `+e+`.`+i+` but it wasn't found.`,t);return}let s=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?s=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(s=this.Versioning.MatrixWorldNeedsUpdate);let c=this.BindingType.Direct;if(a!==void 0){if(i===`morphTargetInfluences`){if(!t.geometry){G(`PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.`,this);return}if(!t.geometry.morphAttributes){G(`PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.`,this);return}t.morphTargetDictionary[a]!==void 0&&(a=t.morphTargetDictionary[a])}c=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=a}else o.fromArray!==void 0&&o.toArray!==void 0?(c=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(c=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=i;this.getValue=this.GetterByBindingType[c],this.setValue=this.SetterByBindingTypeAndVersioning[c][s]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};ws.Composite=Cs,ws.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3},ws.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2},ws.prototype.GetterByBindingType=[ws.prototype._getValue_direct,ws.prototype._getValue_array,ws.prototype._getValue_arrayElement,ws.prototype._getValue_toArray],ws.prototype.SetterByBindingTypeAndVersioning=[[ws.prototype._setValue_direct,ws.prototype._setValue_direct_setNeedsUpdate,ws.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[ws.prototype._setValue_array,ws.prototype._setValue_array_setNeedsUpdate,ws.prototype._setValue_array_setMatrixWorldNeedsUpdate],[ws.prototype._setValue_arrayElement,ws.prototype._setValue_arrayElement_setNeedsUpdate,ws.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[ws.prototype._setValue_fromArray,ws.prototype._setValue_fromArray_setNeedsUpdate,ws.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]],class{static{this.prototype.isMatrix2=!0}constructor(e,t,n,r){this.elements=[1,0,0,1],e!==void 0&&this.set(e,t,n,r)}identity(){return this.set(1,0,0,1),this}fromArray(e,t=0){for(let n=0;n<4;n++)this.elements[n]=e[n+t];return this}set(e,t,n,r){let i=this.elements;return i[0]=e,i[2]=t,i[1]=n,i[3]=r,this}};function Ts(e,t,n,r){let i=Es(r);switch(n){case Vt:return e*t;case Kt:return e*t/i.components*i.byteLength;case qt:return e*t/i.components*i.byteLength;case Jt:return e*t*2/i.components*i.byteLength;case Yt:return e*t*2/i.components*i.byteLength;case Ht:return e*t*3/i.components*i.byteLength;case Ut:return e*t*4/i.components*i.byteLength;case Xt:return e*t*4/i.components*i.byteLength;case Zt:case Qt:return Math.floor((e+3)/4)*Math.floor((t+3)/4)*8;case $t:case en:return Math.floor((e+3)/4)*Math.floor((t+3)/4)*16;case nn:case an:return Math.max(e,16)*Math.max(t,8)/4;case tn:case rn:return Math.max(e,8)*Math.max(t,8)/2;case on:case sn:case ln:case un:return Math.floor((e+3)/4)*Math.floor((t+3)/4)*8;case cn:case dn:case fn:return Math.floor((e+3)/4)*Math.floor((t+3)/4)*16;case pn:return Math.floor((e+3)/4)*Math.floor((t+3)/4)*16;case mn:return Math.floor((e+4)/5)*Math.floor((t+3)/4)*16;case hn:return Math.floor((e+4)/5)*Math.floor((t+4)/5)*16;case gn:return Math.floor((e+5)/6)*Math.floor((t+4)/5)*16;case _n:return Math.floor((e+5)/6)*Math.floor((t+5)/6)*16;case vn:return Math.floor((e+7)/8)*Math.floor((t+4)/5)*16;case yn:return Math.floor((e+7)/8)*Math.floor((t+5)/6)*16;case bn:return Math.floor((e+7)/8)*Math.floor((t+7)/8)*16;case xn:return Math.floor((e+9)/10)*Math.floor((t+4)/5)*16;case Sn:return Math.floor((e+9)/10)*Math.floor((t+5)/6)*16;case Cn:return Math.floor((e+9)/10)*Math.floor((t+7)/8)*16;case wn:return Math.floor((e+9)/10)*Math.floor((t+9)/10)*16;case Tn:return Math.floor((e+11)/12)*Math.floor((t+9)/10)*16;case En:return Math.floor((e+11)/12)*Math.floor((t+11)/12)*16;case Dn:case On:case kn:return Math.ceil(e/4)*Math.ceil(t/4)*16;case An:case jn:return Math.ceil(e/4)*Math.ceil(t/4)*8;case Mn:case Nn:return Math.ceil(e/4)*Math.ceil(t/4)*16}throw Error(`Unable to determine texture byte length for ${n} format.`)}function Es(e){switch(e){case Ot:case kt:return{byteLength:1,components:1};case jt:case At:case Ft:return{byteLength:2,components:1};case It:case Lt:return{byteLength:2,components:4};case Nt:case Mt:case Pt:return{byteLength:4,components:1};case zt:case Bt:return{byteLength:4,components:3}}throw Error(`THREE.TextureUtils: Unknown texture type ${e}.`)}typeof __THREE_DEVTOOLS__<`u`&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent(`register`,{detail:{revision:`187`}})),typeof window<`u`&&(window.__THREE__?W(`WARNING: Multiple instances of Three.js being imported.`):window.__THREE__=`187`);function Ds(){let e=null,t=!1,n=null,r=null;function i(t,a){r=e.requestAnimationFrame(i),n(t,a)}return{start:function(){t!==!0&&n!==null&&e!==null&&(r=e.requestAnimationFrame(i),t=!0)},stop:function(){e!==null&&e.cancelAnimationFrame(r),t=!1},setAnimationLoop:function(e){n=e},setContext:function(t){e=t}}}function Os(e){let t=new WeakMap;function n(t,n){let r=t.array,i=t.usage,a=r.byteLength,o=e.createBuffer();e.bindBuffer(n,o),e.bufferData(n,r,i),t.onUploadCallback();let s;if(r instanceof Float32Array)s=e.FLOAT;else if(typeof Float16Array<`u`&&r instanceof Float16Array)s=e.HALF_FLOAT;else if(r instanceof Uint16Array)s=t.isFloat16BufferAttribute?e.HALF_FLOAT:e.UNSIGNED_SHORT;else if(r instanceof Int16Array)s=e.SHORT;else if(r instanceof Uint32Array)s=e.UNSIGNED_INT;else if(r instanceof Int32Array)s=e.INT;else if(r instanceof Int8Array)s=e.BYTE;else if(r instanceof Uint8Array)s=e.UNSIGNED_BYTE;else if(r instanceof Uint8ClampedArray)s=e.UNSIGNED_BYTE;else throw Error(`THREE.WebGLAttributes: Unsupported buffer data format: `+r);return{buffer:o,type:s,bytesPerElement:r.BYTES_PER_ELEMENT,version:t.version,size:a}}function r(t,n,r){let i=n.array,a=n.updateRanges;if(e.bindBuffer(r,t),a.length===0)e.bufferSubData(r,0,i);else{a.sort((e,t)=>e.start-t.start);let t=0;for(let e=1;e<a.length;e++){let n=a[t],r=a[e];r.start<=n.start+n.count+1?n.count=Math.max(n.count,r.start+r.count-n.start):(++t,a[t]=r)}a.length=t+1;for(let t=0,n=a.length;t<n;t++){let n=a[t];e.bufferSubData(r,n.start*i.BYTES_PER_ELEMENT,i,n.start,n.count)}n.clearUpdateRanges()}n.onUploadCallback()}function i(e){return e.isInterleavedBufferAttribute&&(e=e.data),t.get(e)}function a(n){n.isInterleavedBufferAttribute&&(n=n.data);let r=t.get(n);r&&(e.deleteBuffer(r.buffer),t.delete(n))}function o(e,i){if(e.isInterleavedBufferAttribute&&(e=e.data),e.isGLBufferAttribute){let n=t.get(e);(!n||n.version<e.version)&&t.set(e,{buffer:e.buffer,type:e.type,bytesPerElement:e.elementSize,version:e.version});return}let a=t.get(e);if(a===void 0)t.set(e,n(e,i));else if(a.version<e.version){if(a.size!==e.array.byteLength)throw Error(`THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.`);r(a.buffer,e,i),a.version=e.version}}return{get:i,remove:a,update:o}}var Q={alphahash_fragment:`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,alphahash_pars_fragment:`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,alphamap_fragment:`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,alphamap_pars_fragment:`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,alphatest_fragment:`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,alphatest_pars_fragment:`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,aomap_fragment:`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,aomap_pars_fragment:`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,batching_pars_vertex:`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,batching_vertex:`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,begin_vertex:`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,beginnormal_vertex:`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,bsdfs:`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,iridescence_fragment:`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,bumpmap_pars_fragment:`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,clipping_planes_fragment:`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,clipping_planes_pars_fragment:`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,clipping_planes_pars_vertex:`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,clipping_planes_vertex:`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,color_fragment:`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,color_pars_fragment:`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,color_pars_vertex:`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,color_vertex:`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,common:`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,defaultnormal_vertex:`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,displacementmap_pars_vertex:`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,displacementmap_vertex:`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,emissivemap_fragment:`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,emissivemap_pars_fragment:`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,colorspace_fragment:`gl_FragColor = linearToOutputTexel( gl_FragColor );`,colorspace_pars_fragment:`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,envmap_fragment:`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,envmap_common_pars_fragment:`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,envmap_pars_fragment:`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,envmap_pars_vertex:`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,envmap_physical_pars_fragment:`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,envmap_vertex:`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,fog_vertex:`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,fog_pars_vertex:`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,fog_fragment:`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,fog_pars_fragment:`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,gradientmap_pars_fragment:`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,lightmap_pars_fragment:`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,lights_lambert_fragment:`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,lights_lambert_pars_fragment:`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,lights_pars_begin:`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,lights_toon_fragment:`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,lights_toon_pars_fragment:`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,lights_phong_fragment:`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,lights_phong_pars_fragment:`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,lights_physical_fragment:`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,lights_physical_pars_fragment:`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,lights_fragment_begin:`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,lights_fragment_maps:`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,lights_fragment_end:`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,lightprobes_pars_fragment:`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,logdepthbuf_fragment:`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,logdepthbuf_pars_fragment:`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,logdepthbuf_pars_vertex:`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,logdepthbuf_vertex:`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,map_fragment:`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,map_pars_fragment:`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,map_particle_fragment:`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,map_particle_pars_fragment:`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,metalnessmap_fragment:`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,metalnessmap_pars_fragment:`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,morphinstance_vertex:`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,morphcolor_vertex:`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,morphnormal_vertex:`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,morphtarget_pars_vertex:`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,morphtarget_vertex:`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,normal_fragment_begin:`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,normal_fragment_maps:`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,normal_pars_fragment:`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,normal_pars_vertex:`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,normal_vertex:`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,normalmap_pars_fragment:`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,clearcoat_normal_fragment_begin:`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,clearcoat_normal_fragment_maps:`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,clearcoat_pars_fragment:`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,iridescence_pars_fragment:`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,opaque_fragment:`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,packing:`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,premultiplied_alpha_fragment:`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,project_vertex:`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,dithering_fragment:`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,dithering_pars_fragment:`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,roughnessmap_fragment:`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,roughnessmap_pars_fragment:`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,shadowmap_pars_fragment:`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,shadowmap_pars_vertex:`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,shadowmap_vertex:`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,shadowmask_pars_fragment:`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,skinbase_vertex:`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,skinning_pars_vertex:`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,skinning_vertex:`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,skinnormal_vertex:`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,specularmap_fragment:`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,specularmap_pars_fragment:`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,tonemapping_fragment:`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,tonemapping_pars_fragment:`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,transmission_fragment:`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,transmission_pars_fragment:`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,uv_pars_fragment:`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,uv_pars_vertex:`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,uv_vertex:`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,worldpos_vertex:`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,background_vert:`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,background_frag:`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,backgroundCube_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,backgroundCube_frag:`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,cube_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,cube_frag:`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,depth_vert:`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,depth_frag:`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,distance_vert:`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,distance_frag:`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,equirect_vert:`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,equirect_frag:`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,linedashed_vert:`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,linedashed_frag:`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,meshbasic_vert:`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,meshbasic_frag:`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshlambert_vert:`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshlambert_frag:`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshmatcap_vert:`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,meshmatcap_frag:`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshnormal_vert:`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,meshnormal_frag:`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,meshphong_vert:`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshphong_frag:`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshphysical_vert:`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,meshphysical_frag:`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,meshtoon_vert:`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,meshtoon_frag:`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,points_vert:`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,points_frag:`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,shadow_vert:`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,shadow_frag:`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,sprite_vert:`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,sprite_frag:`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`},$={common:{diffuse:{value:new Z(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new Y},alphaMap:{value:null},alphaMapTransform:{value:new Y},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new Y}},envmap:{envMap:{value:null},envMapRotation:{value:new Y},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new Y}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new Y}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new Y},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new Y},normalScale:{value:new q(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new Y},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new Y}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new Y}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new Y}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Z(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Z(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new Y},alphaTest:{value:0},uvTransform:{value:new Y}},sprite:{diffuse:{value:new Z(16777215)},opacity:{value:1},center:{value:new q(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new Y},alphaMap:{value:null},alphaMapTransform:{value:new Y},alphaTest:{value:0}}},ks={basic:{uniforms:Co([$.common,$.specularmap,$.envmap,$.aomap,$.lightmap,$.fog]),vertexShader:Q.meshbasic_vert,fragmentShader:Q.meshbasic_frag},lambert:{uniforms:Co([$.common,$.specularmap,$.envmap,$.aomap,$.lightmap,$.emissivemap,$.bumpmap,$.normalmap,$.displacementmap,$.fog,$.lights,{emissive:{value:new Z(0)},envMapIntensity:{value:1}}]),vertexShader:Q.meshlambert_vert,fragmentShader:Q.meshlambert_frag},phong:{uniforms:Co([$.common,$.specularmap,$.envmap,$.aomap,$.lightmap,$.emissivemap,$.bumpmap,$.normalmap,$.displacementmap,$.fog,$.lights,{emissive:{value:new Z(0)},specular:{value:new Z(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:Q.meshphong_vert,fragmentShader:Q.meshphong_frag},standard:{uniforms:Co([$.common,$.envmap,$.aomap,$.lightmap,$.emissivemap,$.bumpmap,$.normalmap,$.displacementmap,$.roughnessmap,$.metalnessmap,$.fog,$.lights,{emissive:{value:new Z(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:Q.meshphysical_vert,fragmentShader:Q.meshphysical_frag},toon:{uniforms:Co([$.common,$.aomap,$.lightmap,$.emissivemap,$.bumpmap,$.normalmap,$.displacementmap,$.gradientmap,$.fog,$.lights,{emissive:{value:new Z(0)}}]),vertexShader:Q.meshtoon_vert,fragmentShader:Q.meshtoon_frag},matcap:{uniforms:Co([$.common,$.bumpmap,$.normalmap,$.displacementmap,$.fog,{matcap:{value:null}}]),vertexShader:Q.meshmatcap_vert,fragmentShader:Q.meshmatcap_frag},points:{uniforms:Co([$.points,$.fog]),vertexShader:Q.points_vert,fragmentShader:Q.points_frag},dashed:{uniforms:Co([$.common,$.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:Q.linedashed_vert,fragmentShader:Q.linedashed_frag},depth:{uniforms:Co([$.common,$.displacementmap]),vertexShader:Q.depth_vert,fragmentShader:Q.depth_frag},normal:{uniforms:Co([$.common,$.bumpmap,$.normalmap,$.displacementmap,{opacity:{value:1}}]),vertexShader:Q.meshnormal_vert,fragmentShader:Q.meshnormal_frag},sprite:{uniforms:Co([$.sprite,$.fog]),vertexShader:Q.sprite_vert,fragmentShader:Q.sprite_frag},background:{uniforms:{uvTransform:{value:new Y},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:Q.background_vert,fragmentShader:Q.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new Y}},vertexShader:Q.backgroundCube_vert,fragmentShader:Q.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:Q.cube_vert,fragmentShader:Q.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:Q.equirect_vert,fragmentShader:Q.equirect_frag},distance:{uniforms:Co([$.common,$.displacementmap,{referencePosition:{value:new J},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:Q.distance_vert,fragmentShader:Q.distance_frag},shadow:{uniforms:Co([$.lights,$.fog,{color:{value:new Z(0)},opacity:{value:1}}]),vertexShader:Q.shadow_vert,fragmentShader:Q.shadow_frag}};ks.physical={uniforms:Co([ks.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new Y},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new Y},clearcoatNormalScale:{value:new q(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new Y},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new Y},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new Y},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new Y},sheen:{value:0},sheenColor:{value:new Z(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new Y},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new Y},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new Y},transmissionSamplerSize:{value:new q},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new Y},attenuationDistance:{value:0},attenuationColor:{value:new Z(0)},specularColor:{value:new Z(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new Y},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new Y},anisotropyVector:{value:new q},anisotropyMap:{value:null},anisotropyMapTransform:{value:new Y}}]),vertexShader:Q.meshphysical_vert,fragmentShader:Q.meshphysical_frag};var As={r:0,b:0,g:0},js=new zr,Ms=new Y;Ms.set(-1,0,0,0,1,0,0,0,1);function Ns(e,t,n,r,i,a){let o=new Z(0),s=i===!0?0:1,c,l,u=null,d=0,f=null;function p(e){let n=e.isScene===!0?e.background:null;if(n&&n.isTexture){let r=e.backgroundBlurriness>0;n=t.get(n,r)}return n}function m(t){let r=!1,i=p(t);i===null?g(o,s):i&&i.isColor&&(g(i,1),r=!0);let c=e.xr.getEnvironmentBlendMode();c===`additive`?n.buffers.color.setClear(0,0,0,1,a):c===`alpha-blend`&&n.buffers.color.setClear(0,0,0,0,a),(e.autoClear||r)&&(n.buffers.depth.setTest(!0),n.buffers.depth.setMask(!0),n.buffers.color.setMask(!0),e.clear(e.autoClearColor,e.autoClearDepth,e.autoClearStencil))}function h(t,n){let i=p(n);i&&i.isCubeTexture?(l===void 0&&(l=new za(new bo(1,1,1),new Ao({name:`BackgroundCubeMaterial`,uniforms:So(ks.backgroundCube.uniforms),vertexShader:ks.backgroundCube.vertexShader,fragmentShader:ks.backgroundCube.fragmentShader,side:1,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute(`normal`),l.geometry.deleteAttribute(`uv`),l.onBeforeRender=function(e,t,n){this.matrixWorld.copyPosition(n.matrixWorld)},Object.defineProperty(l.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),r.update(l)),l.material.uniforms.envMap.value=i,l.material.uniforms.backgroundBlurriness.value=n.backgroundBlurriness,l.material.uniforms.backgroundIntensity.value=n.backgroundIntensity,l.material.uniforms.backgroundRotation.value.setFromMatrix4(js.makeRotationFromEuler(n.backgroundRotation)).transpose(),i.isRenderTargetTexture===!1&&l.material.uniforms.backgroundRotation.value.premultiply(Ms),l.material.toneMapped=X.getTransfer(i.colorSpace)!==Gn,(u!==i||d!==i.version||f!==e.toneMapping)&&(l.material.needsUpdate=!0,u=i,d=i.version,f=e.toneMapping),l.layers.enableAll(),t.unshift(l,l.geometry,l.material,0,0,null)):i&&i.isTexture&&(c===void 0&&(c=new za(new xo(2,2),new Ao({name:`BackgroundMaterial`,uniforms:So(ks.background.uniforms),vertexShader:ks.background.vertexShader,fragmentShader:ks.background.fragmentShader,side:0,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute(`normal`),Object.defineProperty(c.material,"map",{get:function(){return this.uniforms.t2D.value}}),r.update(c)),c.material.uniforms.t2D.value=i,c.material.uniforms.backgroundIntensity.value=n.backgroundIntensity,c.material.toneMapped=X.getTransfer(i.colorSpace)!==Gn,i.matrixAutoUpdate===!0&&i.updateMatrix(),c.material.uniforms.uvTransform.value.copy(i.matrix),(u!==i||d!==i.version||f!==e.toneMapping)&&(c.material.needsUpdate=!0,u=i,d=i.version,f=e.toneMapping),c.layers.enableAll(),t.unshift(c,c.geometry,c.material,0,0,null))}function g(t,r){t.getRGB(As,Eo(e)),n.buffers.color.setClear(As.r,As.g,As.b,r,a)}function _(){l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0),c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0)}return{getClearColor:function(){return o},setClearColor:function(e,t=1){o.set(e),s=t,g(o,s)},getClearAlpha:function(){return s},setClearAlpha:function(e){s=e,g(o,s)},render:m,addToRenderList:h,dispose:_}}function Ps(e,t){let n=e.getParameter(e.MAX_VERTEX_ATTRIBS),r={},i=f(null),a=i,o=!1;function s(n,r,i,s,c){let u=!1,f=d(n,s,i,r);a!==f&&(a=f,l(a.object)),u=p(n,s,i,c),u&&m(n,s,i,c),c!==null&&t.update(c,e.ELEMENT_ARRAY_BUFFER),(u||o)&&(o=!1,b(n,r,i,s),c!==null&&e.bindBuffer(e.ELEMENT_ARRAY_BUFFER,t.get(c).buffer))}function c(){return e.createVertexArray()}function l(t){return e.bindVertexArray(t)}function u(t){return e.deleteVertexArray(t)}function d(e,t,n,i){let a=i.wireframe===!0,o=r[t.id];o===void 0&&(o={},r[t.id]=o);let s=e.isInstancedMesh===!0?e.id:0,l=o[s];l===void 0&&(l={},o[s]=l);let u=l[n.id];u===void 0&&(u={},l[n.id]=u);let d=u[a];return d===void 0&&(d=f(c()),u[a]=d),d}function f(e){let t=[],r=[],i=[];for(let e=0;e<n;e++)t[e]=0,r[e]=0,i[e]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:t,enabledAttributes:r,attributeDivisors:i,object:e,attributes:{},index:null}}function p(e,t,n,r){let i=a.attributes,o=t.attributes,s=0,c=n.getAttributes();for(let t in c)if(c[t].location>=0){let n=i[t],r=o[t];if(r===void 0&&(t===`instanceMatrix`&&e.instanceMatrix&&(r=e.instanceMatrix),t===`instanceColor`&&e.instanceColor&&(r=e.instanceColor)),n===void 0||n.attribute!==r||r&&n.data!==r.data)return!0;s++}return a.attributesNum!==s||a.index!==r}function m(e,t,n,r){let i={},o=t.attributes,s=0,c=n.getAttributes();for(let t in c)if(c[t].location>=0){let n=o[t];n===void 0&&(t===`instanceMatrix`&&e.instanceMatrix&&(n=e.instanceMatrix),t===`instanceColor`&&e.instanceColor&&(n=e.instanceColor));let r={};r.attribute=n,n&&n.data&&(r.data=n.data),i[t]=r,s++}a.attributes=i,a.attributesNum=s,a.index=r}function h(){let e=a.newAttributes;for(let t=0,n=e.length;t<n;t++)e[t]=0}function g(e){_(e,0)}function _(t,n){let r=a.newAttributes,i=a.enabledAttributes,o=a.attributeDivisors;r[t]=1,i[t]===0&&(e.enableVertexAttribArray(t),i[t]=1),o[t]!==n&&(e.vertexAttribDivisor(t,n),o[t]=n)}function v(){let t=a.newAttributes,n=a.enabledAttributes;for(let r=0,i=n.length;r<i;r++)n[r]!==t[r]&&(e.disableVertexAttribArray(r),n[r]=0)}function y(t,n,r,i,a,o,s){s===!0?e.vertexAttribIPointer(t,n,r,a,o):e.vertexAttribPointer(t,n,r,i,a,o)}function b(n,r,i,a){h();let o=a.attributes,s=i.getAttributes(),c=r.defaultAttributeValues;for(let r in s){let i=s[r];if(i.location>=0){let s=o[r];if(s===void 0&&(r===`instanceMatrix`&&n.instanceMatrix&&(s=n.instanceMatrix),r===`instanceColor`&&n.instanceColor&&(s=n.instanceColor)),s!==void 0){let r=s.normalized,o=s.itemSize,c=t.get(s);if(c===void 0)continue;let l=c.buffer,u=c.type,d=c.bytesPerElement,f=u===e.INT||u===e.UNSIGNED_INT||s.gpuType===1013;if(s.isInterleavedBufferAttribute){let t=s.data,c=t.isInterleavedBuffer===!0?t.stride:t.itemSize,p=s.offset;if(t.isInstancedInterleavedBuffer||t.isInstancedBufferAttribute){for(let e=0;e<i.locationSize;e++)_(i.location+e,t.meshPerAttribute);n.isInstancedMesh!==!0&&a._maxInstanceCount===void 0&&(a._maxInstanceCount=t.meshPerAttribute*t.count)}else for(let e=0;e<i.locationSize;e++)g(i.location+e);e.bindBuffer(e.ARRAY_BUFFER,l);for(let e=0;e<i.locationSize;e++)y(i.location+e,o/i.locationSize,u,r,c*d,(p+o/i.locationSize*e)*d,f)}else{if(s.isInstancedBufferAttribute){for(let e=0;e<i.locationSize;e++)_(i.location+e,s.meshPerAttribute);n.isInstancedMesh!==!0&&a._maxInstanceCount===void 0&&(a._maxInstanceCount=s.meshPerAttribute*s.count)}else for(let e=0;e<i.locationSize;e++)g(i.location+e);e.bindBuffer(e.ARRAY_BUFFER,l);for(let e=0;e<i.locationSize;e++)y(i.location+e,o/i.locationSize,u,r,o*d,o/i.locationSize*e*d,f)}}else if(c!==void 0){let t=c[r];if(t!==void 0)switch(t.length){case 2:e.vertexAttrib2fv(i.location,t);break;case 3:e.vertexAttrib3fv(i.location,t);break;case 4:e.vertexAttrib4fv(i.location,t);break;default:e.vertexAttrib1fv(i.location,t)}}}}v()}function x(){T();for(let e in r){let t=r[e];for(let e in t){let n=t[e];for(let e in n){let t=n[e];for(let e in t)u(t[e].object),delete t[e];delete n[e]}}delete r[e]}}function S(e){if(r[e.id]===void 0)return;let t=r[e.id];for(let e in t){let n=t[e];for(let e in n){let t=n[e];for(let e in t)u(t[e].object),delete t[e];delete n[e]}}delete r[e.id]}function C(e){for(let t in r){let n=r[t];for(let t in n){let r=n[t];if(r[e.id]===void 0)continue;let i=r[e.id];for(let e in i)u(i[e].object),delete i[e];delete r[e.id]}}}function w(e){for(let t in r){let n=r[t],i=e.isInstancedMesh===!0?e.id:0,a=n[i];if(a!==void 0){for(let e in a){let t=a[e];for(let e in t)u(t[e].object),delete t[e];delete a[e]}delete n[i],Object.keys(n).length===0&&delete r[t]}}}function T(){E(),o=!0,a!==i&&(a=i,l(a.object))}function E(){i.geometry=null,i.program=null,i.wireframe=!1}return{setup:s,reset:T,resetDefaultState:E,dispose:x,releaseStatesOfGeometry:S,releaseStatesOfObject:w,releaseStatesOfProgram:C,initAttributes:h,enableAttribute:g,disableUnusedAttributes:v}}function Fs(e,t,n){let r;function i(e){r=e}function a(t,i){e.drawArrays(r,t,i),n.update(i,r,1)}function o(t,i,a){a!==0&&(e.drawArraysInstanced(r,t,i,a),n.update(i,r,a))}function s(e,i,a){if(a===0)return;t.get(`WEBGL_multi_draw`).multiDrawArraysWEBGL(r,e,0,i,0,a);let o=0;for(let e=0;e<a;e++)o+=i[e];n.update(o,r,1)}this.setMode=i,this.render=a,this.renderInstances=o,this.renderMultiDraw=s}function Is(e,t,n,r){let i;function a(){if(i!==void 0)return i;if(t.has(`EXT_texture_filter_anisotropic`)===!0){let n=t.get(`EXT_texture_filter_anisotropic`);i=e.getParameter(n.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else i=0;return i}function o(t){return t===1023||r.convert(t)===e.getParameter(e.IMPLEMENTATION_COLOR_READ_FORMAT)}function s(n){let i=n===1016&&(t.has(`EXT_color_buffer_half_float`)||t.has(`EXT_color_buffer_float`));return!(n!==1009&&n!==1015&&!i&&r.convert(n)!==e.getParameter(e.IMPLEMENTATION_COLOR_READ_TYPE))}function c(t){if(t===`highp`){if(e.getShaderPrecisionFormat(e.VERTEX_SHADER,e.HIGH_FLOAT).precision>0&&e.getShaderPrecisionFormat(e.FRAGMENT_SHADER,e.HIGH_FLOAT).precision>0)return`highp`;t=`mediump`}return t===`mediump`&&e.getShaderPrecisionFormat(e.VERTEX_SHADER,e.MEDIUM_FLOAT).precision>0&&e.getShaderPrecisionFormat(e.FRAGMENT_SHADER,e.MEDIUM_FLOAT).precision>0?`mediump`:`lowp`}let l=n.precision===void 0?`highp`:n.precision,u=c(l);u!==l&&(W(`WebGLRenderer:`,l,`not supported, using`,u,`instead.`),l=u);let d=n.reversedDepthBuffer===!0&&t.has(`EXT_clip_control`),f=n.logarithmicDepthBuffer===!0&&d===!1;n.reversedDepthBuffer===!0&&d===!1&&W(`WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer.`),n.logarithmicDepthBuffer===!0&&d===!0&&W(`WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.`);let p=e.getParameter(e.MAX_TEXTURE_IMAGE_UNITS),m=e.getParameter(e.MAX_VERTEX_TEXTURE_IMAGE_UNITS),h=e.getParameter(e.MAX_TEXTURE_SIZE),g=e.getParameter(e.MAX_CUBE_MAP_TEXTURE_SIZE),_=e.getParameter(e.MAX_VERTEX_ATTRIBS),v=e.getParameter(e.MAX_VERTEX_UNIFORM_VECTORS),y=e.getParameter(e.MAX_VARYING_VECTORS),b=e.getParameter(e.MAX_FRAGMENT_UNIFORM_VECTORS),x=e.getParameter(e.MAX_SAMPLES),S=e.getParameter(e.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:a,getMaxPrecision:c,textureFormatReadable:o,textureTypeReadable:s,precision:l,logarithmicDepthBuffer:f,reversedDepthBuffer:d,maxTextures:p,maxVertexTextures:m,maxTextureSize:h,maxCubemapSize:g,maxAttributes:_,maxVertexUniforms:v,maxVaryings:y,maxFragmentUniforms:b,maxSamples:x,samples:S}}function Ls(e){let t=this,n=null,r=0,i=!1,a=!1,o=new ya,s=new Y,c={value:null,needsUpdate:!1};this.uniform=c,this.numPlanes=0,this.numIntersection=0,this.init=function(e,t){let n=e.length!==0||t||r!==0||i;return i=t,r=e.length,n},this.beginShadows=function(){a=!0,u(null)},this.endShadows=function(){a=!1},this.setGlobalState=function(e,t){n=u(e,t,0)},this.setState=function(t,o,s){let d=t.clippingPlanes,f=t.clipIntersection,p=t.clipShadows,m=e.get(t);if(!i||d===null||d.length===0||a&&!p)a?u(null):l();else{let e=a?0:r,t=e*4,i=m.clippingState||null;c.value=i,i=u(d,o,t,s);for(let e=0;e!==t;++e)i[e]=n[e];m.clippingState=i,this.numIntersection=f?this.numPlanes:0,this.numPlanes+=e}};function l(){c.value!==n&&(c.value=n,c.needsUpdate=r>0),t.numPlanes=r,t.numIntersection=0}function u(e,n,r,i){let a=e===null?0:e.length,l=null;if(a!==0){if(l=c.value,i!==!0||l===null){let t=r+a*4,i=n.matrixWorldInverse;s.getNormalMatrix(i),(l===null||l.length<t)&&(l=new Float32Array(t));for(let t=0,n=r;t!==a;++t,n+=4)o.copy(e[t]).applyMatrix4(i,s),o.normal.toArray(l,n),l[n+3]=o.constant}c.value=l,c.needsUpdate=!0}return t.numPlanes=a,t.numIntersection=0,l}}var Rs=class extends Ir{constructor(e=1,t={}){super(e,e,t),this.isWebGLCubeRenderTarget=!0;let n={width:e,height:e,depth:1},r=[n,n,n,n,n,n];this.texture=new go(r),this._setTextureOptions(t),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(e,t){this.texture.type=t.type,this.texture.colorSpace=t.colorSpace,this.texture.generateMipmaps=t.generateMipmaps,this.texture.minFilter=t.minFilter,this.texture.magFilter=t.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},r=new bo(5,5,5),i=new Ao({name:`CubemapFromEquirect`,uniforms:So(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:1,blending:0});i.uniforms.tEquirect.value=t;let a=new za(r,i),o=t.minFilter;return t.minFilter===1008&&(t.minFilter=Tt),new ds(1,10,this).update(e,a),t.minFilter=o,a.geometry.dispose(),a.material.dispose(),this}clear(e,t=!0,n=!0,r=!0){let i=e.getRenderTarget();for(let i=0;i<6;i++)e.setRenderTarget(this,i),e.clear(t,n,r);e.setRenderTarget(i)}},zs=256,Bs=3,Vs=20,Hs=256,Us=16,Ws=3,Gs=new J,Ks=new Z,qs=class e{constructor(e){this._renderer=e,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new ds(1,10,null),this._boxMesh=new za(new bo(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(e,t=0,n=.1,r=100,i={}){let{size:a=256,position:o=Gs}=i,s=this._renderer;this._setSize(a);let c=this._allocateTarget(),l=this._getSourceTarget(!0);t>0&&(l.texture.mipmapsAutoUpdate=!1);let u=s.autoClear,d=s.autoClearColor,f=s.autoClearDepth,p=s.autoClearStencil,m=e.background;s.autoClear=!0,s.autoClearColor=!0,s.autoClearDepth=!0,s.autoClearStencil=!0,m===null&&(e.background=s.getClearColor(Ks));let h=new ds(n,r,l);return h.position.copy(o),h.update(s,e),s.autoClear=u,s.autoClearColor=d,s.autoClearDepth=f,s.autoClearStencil=p,e.background=m,t>0&&(l.texture.mipmapsAutoUpdate=!0,this._blur(c,t)),this._applyPMREM(c),c}fromEquirectangular(e,t=null){return this._fromTexture(e,t)}fromCubemap(e,t=null){return this._fromTexture(e,t)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=ec(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=$s(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(e,t){return t>0?1-Math.sqrt(1-e/t):0}_setSize(e){this._cubeSize=Math.max(zs,pr(e))}_fromTexture(e,t){e.mapping===301||e.mapping===302?this._setSize(e.image.length===0?zs:e.image[0].width||e.image[0].image.width):this._setSize(e.image.width/4);let n=t||this._allocateTarget();return this._textureToCubemap(e),this._applyPMREM(n),n}_allocateTarget(){let e=this._cubeSize,t=Js(e,!1,!1),n=Math.log2(e)-Bs;for(let r=0;r<=n;r++)t.texture.mipmaps.push({width:e>>r,height:e>>r});return t.texture.name=`PMREM`,t.texture.isPMREMTexture=!0,t}_getSourceTarget(e=!1){let t=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==t||e&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=Js(t,!0,e)),this._sourceTarget}_compileMaterial(e){this._boxMesh.material=e,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(e,t,n){let r=this._boxMesh,i=this._cubeCamera;r.material=n,i.renderTarget=e,i.activeMipmapLevel=t;let a=e.width>>t;e.viewport.set(0,0,a,a),i.update(this._renderer,r),e.viewport.set(0,0,e.width,e.height)}_textureToCubemap(e){let t;e.mapping===301||e.mapping===302?(this._cubemapMaterial===null&&(this._cubemapMaterial=ec()),t=this._cubemapMaterial,t.uniforms.flipEnvMap.value=e.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=$s()),t=this._equirectMaterial),t.uniforms.envMap.value=e,this._renderCube(this._getSourceTarget(),0,t)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=Xs(),this._integrationMaterial=Zs());let n=this._cubeSize,r=t.texture.mipmaps.length-1,i=this._ggxMaterial.uniforms;i.envMap.value=this._sourceTarget.texture;let a=this._integrationMaterial.uniforms;a.envMap.value=this._sourceTarget.texture,a.sourceLod.value=Math.log2(n/Us);for(let o=0;o<=r;o++){let s=e.lodToRoughness(o,r);if(o>r-Ws)a.roughness.value=s,this._renderCube(t,o,this._integrationMaterial);else{let e=s>0?Math.log2(n)+.5*Math.log2(6/(Hs*s**4))+.5:0;i.roughness.value=s,i.lodBias.value=e,this._renderCube(t,o,this._ggxMaterial)}}}_blur(e,t){this._blurMaterial===null&&(this._blurMaterial=Qs());let n=this._blurMaterial,r=n.uniforms,i=this._sourceTarget;r.sigma.value=Math.min(t,Math.PI)/Math.SQRT2,r.envMap.value=i.texture,this._renderCube(e,0,n),r.envMap.value=e.texture,this._renderCube(i,0,n)}};function Js(e,t,n){return new Rs(e,{minFilter:Dt,generateMipmaps:t,type:Ft,colorSpace:Un,depthBuffer:n})}function Ys(e,t,n){return new Ao({name:e,uniforms:t,vertexShader:Q.cube_vert,fragmentShader:n,side:1,blending:0,depthTest:!1,depthWrite:!1})}function Xs(){return Ys(`PMREMGGXConvolution`,{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${Hs}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Zs(){return Ys(`PMREMGGXIntegration`,{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Us}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Qs(){return Ys(`PMREMSphericalGaussianBlur`,{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${Vs}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function $s(){return Ys(`PMREMEquirectangularToCubemap`,{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function ec(){return Ys(`PMREMCubemapToCubemap`,{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function tc(e){let t=new WeakMap,n=new WeakMap,r=null;function i(e,t=!1){return e==null?null:t?o(e):a(e)}function a(n){if(n&&n.isTexture){let r=n.mapping;if(r===303||r===304){if(t.has(n)){let e=t.get(n).texture;return s(e,n.mapping)}{let r=n.image;if(r&&r.height>0){let i=new Rs(r.height);return i.fromEquirectangularTexture(e,n),t.set(n,i),n.addEventListener(`dispose`,l),s(i.texture,n.mapping)}return null}}}return n}function o(t){if(t&&t.isTexture&&t.isPMREMTexture!==!0){let i=t.mapping,a=i===303||i===304,o=i===301||i===302;if(a||o){let i=n.get(t),s=i===void 0?0:i.texture.pmremVersion;if(t.isRenderTargetTexture&&t.pmremVersion!==s)return r===null&&(r=new qs(e)),i=a?r.fromEquirectangular(t,i):r.fromCubemap(t,i),i.texture.pmremVersion=t.pmremVersion,n.set(t,i),i.texture;if(i!==void 0)return i.texture;{let s=t.image;return a&&s&&s.height>0||o&&s&&c(s)?(r===null&&(r=new qs(e)),i=a?r.fromEquirectangular(t):r.fromCubemap(t),i.texture.pmremVersion=t.pmremVersion,n.set(t,i),t.addEventListener(`dispose`,u),i.texture):null}}}return t}function s(e,t){return t===303?e.mapping=301:t===304&&(e.mapping=302),e}function c(e){let t=0;for(let n=0;n<6;n++)e[n]!==void 0&&t++;return t===6}function l(e){let n=e.target;n.removeEventListener(`dispose`,l);let r=t.get(n);r!==void 0&&(t.delete(n),r.dispose())}function u(e){let t=e.target;t.removeEventListener(`dispose`,u);let r=n.get(t);r!==void 0&&(n.delete(t),r.dispose())}function d(){t=new WeakMap,n=new WeakMap,r!==null&&(r.dispose(),r=null)}return{get:i,dispose:d}}function nc(e){let t={};function n(n){if(t[n]!==void 0)return t[n];let r=e.getExtension(n);return t[n]=r,r}return{has:function(e){return n(e)!==null},init:function(){n(`EXT_color_buffer_float`),n(`WEBGL_clip_cull_distance`),n(`OES_texture_float_linear`),n(`EXT_color_buffer_half_float`),n(`WEBGL_multisampled_render_to_texture`),n(`WEBGL_render_shared_exponent`)},get:function(e){let t=n(e);return t===null&&rr(`WebGLRenderer: `+e+` extension not supported.`),t}}}function rc(e,t,n,r){let i={},a=new WeakMap,o=new FinalizationRegistry(e=>delete i[e]);function s(e){c(e.target)}function c(e){e.index!==null&&t.remove(e.index);for(let n in e.attributes)t.remove(e.attributes[n]);e.removeEventListener(`dispose`,s),delete i[e.id],o.unregister(e);let c=a.get(e);c&&(t.remove(c),a.delete(e)),r.releaseStatesOfGeometry(e),e.isInstancedBufferGeometry===!0&&delete e._maxInstanceCount,n.memory.geometries--}function l(e,t){return i[t.id]===void 0&&(t.addEventListener(`dispose`,s),i[t.id]=new WeakRef(t),o.register(t,t.id,t),n.memory.geometries++),t}function u(n){let r=n.attributes;for(let n in r)t.update(r[n],e.ARRAY_BUFFER)}function d(e){let n=e.index,r=e.attributes.position,i=0;if(r===void 0)return;let o=n===null?r.array.length/3-1:n.array.length,s=new(r.count>=65535?na:ta)(Math.ceil(o/3)*6,1),c=s.array;if(n!==null){let e=n.array;i=n.version;for(let t=0,n=0;t<o;t+=3){let r=e[t+0],i=e[t+1],a=e[t+2];c[n++]=r,c[n++]=i,c[n++]=i,c[n++]=a,c[n++]=a,c[n++]=r}}else{i=r.version;for(let e=0,t=0;e<o;e+=3){let n=e+0,r=e+1,i=e+2;c[t++]=n,c[t++]=r,c[t++]=r,c[t++]=i,c[t++]=i,c[t++]=n}}s.version=i;let l=a.get(e);l&&t.remove(l),a.set(e,s)}function f(e){let t=a.get(e);if(t){let n=e.index;n!==null&&t.version<n.version&&d(e)}else d(e);return a.get(e)}function p(){for(let e in i){let t=i[e].deref();t!==void 0&&c(t)}}return{get:l,update:u,getWireframeAttribute:f,dispose:p}}function ic(e,t,n){let r;function i(e){r=e}let a,o;function s(e){a=e.type,o=e.bytesPerElement}function c(t,i){e.drawElements(r,i,a,t*o),n.update(i,r,1)}function l(t,i,s){s!==0&&(e.drawElementsInstanced(r,i,a,t*o,s),n.update(i,r,s))}function u(e,i,o){if(o===0)return;t.get(`WEBGL_multi_draw`).multiDrawElementsWEBGL(r,i,0,a,e,0,o);let s=0;for(let e=0;e<o;e++)s+=i[e];n.update(s,r,1)}this.setMode=i,this.setIndex=s,this.render=c,this.renderInstances=l,this.renderMultiDraw=u}function ac(e){let t={geometries:0,textures:0},n={frame:0,calls:0,triangles:0,points:0,lines:0};function r(t,r,i){switch(n.calls++,r){case e.TRIANGLES:n.triangles+=t/3*i;break;case e.LINES:n.lines+=t/2*i;break;case e.LINE_STRIP:n.lines+=i*(t-1);break;case e.LINE_LOOP:n.lines+=i*t;break;case e.POINTS:n.points+=i*t;break;default:G(`WebGLInfo: Unknown draw mode:`,r)}}function i(){n.calls=0,n.triangles=0,n.points=0,n.lines=0}return{memory:t,render:n,programs:null,autoReset:!0,reset:i,update:r}}function oc(e,t,n){let r=new WeakMap,i=new Pr;function a(a,o,s){let c=a.morphTargetInfluences,l=o.morphAttributes.position||o.morphAttributes.normal||o.morphAttributes.color,u=l===void 0?0:l.length,d=r.get(o);if(d===void 0||d.count!==u){d!==void 0&&d.texture.dispose();let e=o.morphAttributes.position!==void 0,n=o.morphAttributes.normal!==void 0,a=o.morphAttributes.color!==void 0,s=o.morphAttributes.position||[],c=o.morphAttributes.normal||[],l=o.morphAttributes.color||[],f=0;e===!0&&(f=1),n===!0&&(f=2),a===!0&&(f=3);let p=o.attributes.position.count*f,m=1;p>t.maxTextureSize&&(m=Math.ceil(p/t.maxTextureSize),p=t.maxTextureSize);let h=new Float32Array(p*m*4*u),g=new Lr(h,p,m,u);g.type=Pt,g.needsUpdate=!0;let _=f*4;for(let t=0;t<u;t++){let r=s[t],o=c[t],u=l[t],d=p*m*4*t;for(let t=0;t<r.count;t++){let s=t*_;e===!0&&(i.fromBufferAttribute(r,t),h[d+s+0]=i.x,h[d+s+1]=i.y,h[d+s+2]=i.z,h[d+s+3]=0),n===!0&&(i.fromBufferAttribute(o,t),h[d+s+4]=i.x,h[d+s+5]=i.y,h[d+s+6]=i.z,h[d+s+7]=0),a===!0&&(i.fromBufferAttribute(u,t),h[d+s+8]=i.x,h[d+s+9]=i.y,h[d+s+10]=i.z,h[d+s+11]=u.itemSize===4?i.w:1)}}d={count:u,texture:g,size:new q(p,m)},r.set(o,d);function v(){g.dispose(),r.delete(o),o.removeEventListener(`dispose`,v)}o.addEventListener(`dispose`,v)}if(a.isInstancedMesh===!0&&a.morphTexture!==null)s.getUniforms().setValue(e,`morphTexture`,a.morphTexture,n);else{let t=0;for(let e=0;e<c.length;e++)t+=c[e];let n=o.morphTargetsRelative?1:1-t;s.getUniforms().setValue(e,`morphTargetBaseInfluence`,n),s.getUniforms().setValue(e,`morphTargetInfluences`,c)}s.getUniforms().setValue(e,`morphTargetsTexture`,d.texture,n),s.getUniforms().setValue(e,`morphTargetsTextureSize`,d.size)}return{update:a}}function sc(e,t,n,r,i){let a=new WeakMap;function o(r){let o=i.render.frame,s=r.geometry,l=t.get(r,s);if(a.get(l)!==o&&(t.update(l),a.set(l,o)),r.isInstancedMesh&&(r.hasEventListener(`dispose`,c)===!1&&r.addEventListener(`dispose`,c),a.get(r)!==o&&(n.update(r.instanceMatrix,e.ARRAY_BUFFER),r.instanceColor!==null&&n.update(r.instanceColor,e.ARRAY_BUFFER),a.set(r,o))),r.isSkinnedMesh){let e=r.skeleton;a.get(e)!==o&&(e.update(),a.set(e,o))}return l}function s(){a=new WeakMap}function c(e){let t=e.target;t.removeEventListener(`dispose`,c),r.releaseStatesOfObject(t),n.remove(t.instanceMatrix),t.instanceColor!==null&&n.remove(t.instanceColor)}return{update:o,dispose:s}}var cc={1:`LINEAR_TONE_MAPPING`,2:`REINHARD_TONE_MAPPING`,3:`CINEON_TONE_MAPPING`,4:`ACES_FILMIC_TONE_MAPPING`,6:`AGX_TONE_MAPPING`,7:`NEUTRAL_TONE_MAPPING`,5:`CUSTOM_TONE_MAPPING`};function lc(e,t,n,r,i,a){let o=new Ir(t,n,{type:e,depthBuffer:i,stencilBuffer:a,samples:r?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),s=null,c=null,l=null,u=new ha;u.setAttribute(`position`,new ra([-1,3,0,-1,-1,0,3,-1,0],3)),u.setAttribute(`uv`,new ra([0,2,0,0,2,0],2));let d=new jo({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),f=new za(u,d),p=new cs(-1,1,1,-1,0,1),m=null,h=null,g=!1,_,v=null,y=[],b=!1;this.setSize=function(e,t){o.setSize(e,t),s!==null&&s.setSize(e,t),c!==null&&c.setSize(e,t);for(let n=0;n<y.length;n++){let r=y[n];r.setSize&&r.setSize(e,t)}},this.setEffects=function(e){y=e,b=y.length>0&&y[0].isRenderPass===!0;let t=o.width,n=o.height;y.length>0&&s===null&&(s=new Ir(t,n,{type:Ft,depthBuffer:!1,stencilBuffer:!1}),c=new Ir(t,n,{type:Ft,depthBuffer:!1,stencilBuffer:!1}));let r=i===!0&&y.some(e=>e.needsDepthTexture===!0);r!==(o.depthTexture!==null)&&(r===!0&&l===null&&(l=new _o(t,n),a===!0&&(l.format=Gt,l.type=Rt)),o.dispose(),o.depthTexture=r?l:null,o.resolveDepthBuffer=r,o.storeMultisampledDepthBuffer=r);for(let e=0;e<y.length;e++){let i=y[e];i.setSize&&i.setSize(t,n),r&&i.needsDepthTexture===!0&&i.setDepthTexture&&i.setDepthTexture(l)}},this.begin=function(e,t){if(g||e.toneMapping===0&&y.length===0)return!1;if(v=t,t!==null){let e=t.width,n=t.height;(o.width!==e||o.height!==n)&&this.setSize(e,n)}return b===!1&&e.setRenderTarget(o),_=e.toneMapping,e.toneMapping=0,!0},this.hasRenderPass=function(){return b},this.end=function(e,t){e.toneMapping=_,g=!0;let n=o,r=s;for(let i=0;i<y.length;i++){let a=y[i];a.enabled!==!1&&(a.render(e,r,n,t),a.needsSwap!==!1&&(n=r,r=r===s?c:s))}if(m!==e.outputColorSpace||h!==e.toneMapping){m=e.outputColorSpace,h=e.toneMapping,d.defines={},X.getTransfer(m)===`srgb`&&(d.defines.SRGB_TRANSFER=``);let t=cc[h];t&&(d.defines[t]=``),d.needsUpdate=!0}d.uniforms.tDiffuse.value=n.texture,e.setRenderTarget(v),e.render(f,p),v=null,g=!1},this.isCompositing=function(){return g},this.dispose=function(){o.dispose(),s!==null&&s.dispose(),c!==null&&c.dispose(),u.dispose(),d.dispose()}}var uc=new Nr,dc=new _o(1,1),fc=new vo(1),pc=new Lr,mc=new Rr,hc=new go,gc=[],_c=[],vc=new Float32Array(16),yc=new Float32Array(9),bc=new Float32Array(4);function xc(e,t,n){let r=e[0];if(r<=0||r>0)return e;let i=t*n,a=gc[i];if(a===void 0&&(a=new Float32Array(i),gc[i]=a),t!==0){r.toArray(a,0);for(let r=1,i=0;r!==t;++r)i+=n,e[r].toArray(a,i)}return a}function Sc(e,t){if(e.length!==t.length)return!1;for(let n=0,r=e.length;n<r;n++)if(e[n]!==t[n])return!1;return!0}function Cc(e,t){for(let n=0,r=t.length;n<r;n++)e[n]=t[n]}function wc(e,t){let n=_c[t];n===void 0&&(n=new Int32Array(t),_c[t]=n);for(let r=0;r!==t;++r)n[r]=e.allocateTextureUnit();return n}function Tc(e,t){let n=this.cache;n[0]!==t&&(e.uniform1f(this.addr,t),n[0]=t)}function Ec(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y)&&(e.uniform2f(this.addr,t.x,t.y),n[0]=t.x,n[1]=t.y);else{if(Sc(n,t))return;e.uniform2fv(this.addr,t),Cc(n,t)}}function Dc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z)&&(e.uniform3f(this.addr,t.x,t.y,t.z),n[0]=t.x,n[1]=t.y,n[2]=t.z);else if(t.r!==void 0)(n[0]!==t.r||n[1]!==t.g||n[2]!==t.b)&&(e.uniform3f(this.addr,t.r,t.g,t.b),n[0]=t.r,n[1]=t.g,n[2]=t.b);else{if(Sc(n,t))return;e.uniform3fv(this.addr,t),Cc(n,t)}}function Oc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z||n[3]!==t.w)&&(e.uniform4f(this.addr,t.x,t.y,t.z,t.w),n[0]=t.x,n[1]=t.y,n[2]=t.z,n[3]=t.w);else{if(Sc(n,t))return;e.uniform4fv(this.addr,t),Cc(n,t)}}function kc(e,t){let n=this.cache,r=t.elements;if(r===void 0){if(Sc(n,t))return;e.uniformMatrix2fv(this.addr,!1,t),Cc(n,t)}else{if(Sc(n,r))return;bc.set(r),e.uniformMatrix2fv(this.addr,!1,bc),Cc(n,r)}}function Ac(e,t){let n=this.cache,r=t.elements;if(r===void 0){if(Sc(n,t))return;e.uniformMatrix3fv(this.addr,!1,t),Cc(n,t)}else{if(Sc(n,r))return;yc.set(r),e.uniformMatrix3fv(this.addr,!1,yc),Cc(n,r)}}function jc(e,t){let n=this.cache,r=t.elements;if(r===void 0){if(Sc(n,t))return;e.uniformMatrix4fv(this.addr,!1,t),Cc(n,t)}else{if(Sc(n,r))return;vc.set(r),e.uniformMatrix4fv(this.addr,!1,vc),Cc(n,r)}}function Mc(e,t){let n=this.cache;n[0]!==t&&(e.uniform1i(this.addr,t),n[0]=t)}function Nc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y)&&(e.uniform2i(this.addr,t.x,t.y),n[0]=t.x,n[1]=t.y);else{if(Sc(n,t))return;e.uniform2iv(this.addr,t),Cc(n,t)}}function Pc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z)&&(e.uniform3i(this.addr,t.x,t.y,t.z),n[0]=t.x,n[1]=t.y,n[2]=t.z);else{if(Sc(n,t))return;e.uniform3iv(this.addr,t),Cc(n,t)}}function Fc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z||n[3]!==t.w)&&(e.uniform4i(this.addr,t.x,t.y,t.z,t.w),n[0]=t.x,n[1]=t.y,n[2]=t.z,n[3]=t.w);else{if(Sc(n,t))return;e.uniform4iv(this.addr,t),Cc(n,t)}}function Ic(e,t){let n=this.cache;n[0]!==t&&(e.uniform1ui(this.addr,t),n[0]=t)}function Lc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y)&&(e.uniform2ui(this.addr,t.x,t.y),n[0]=t.x,n[1]=t.y);else{if(Sc(n,t))return;e.uniform2uiv(this.addr,t),Cc(n,t)}}function Rc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z)&&(e.uniform3ui(this.addr,t.x,t.y,t.z),n[0]=t.x,n[1]=t.y,n[2]=t.z);else{if(Sc(n,t))return;e.uniform3uiv(this.addr,t),Cc(n,t)}}function zc(e,t){let n=this.cache;if(t.x!==void 0)(n[0]!==t.x||n[1]!==t.y||n[2]!==t.z||n[3]!==t.w)&&(e.uniform4ui(this.addr,t.x,t.y,t.z,t.w),n[0]=t.x,n[1]=t.y,n[2]=t.z,n[3]=t.w);else{if(Sc(n,t))return;e.uniform4uiv(this.addr,t),Cc(n,t)}}function Bc(e){return e.version===0&&(e.compareFunction=519,e.needsUpdate=!0),e}function Vc(e,t,n){let r=this.cache,i=n.allocateTextureUnit();r[0]!==i&&(e.uniform1i(this.addr,i),r[0]=i);let a;a=this.type===e.SAMPLER_2D_SHADOW?Bc(dc):uc,n.setTexture2D(t||a,i)}function Hc(e,t,n){let r=this.cache,i=n.allocateTextureUnit();r[0]!==i&&(e.uniform1i(this.addr,i),r[0]=i),n.setTexture3D(t||mc,i)}function Uc(e,t,n){let r=this.cache,i=n.allocateTextureUnit();r[0]!==i&&(e.uniform1i(this.addr,i),r[0]=i);let a;a=this.type===e.SAMPLER_CUBE_SHADOW?Bc(fc):hc,n.setTextureCube(t||a,i)}function Wc(e,t,n){let r=this.cache,i=n.allocateTextureUnit();r[0]!==i&&(e.uniform1i(this.addr,i),r[0]=i),n.setTexture2DArray(t||pc,i)}function Gc(e){switch(e){case 5126:return Tc;case 35664:return Ec;case 35665:return Dc;case 35666:return Oc;case 35674:return kc;case 35675:return Ac;case 35676:return jc;case 5124:case 35670:return Mc;case 35667:case 35671:return Nc;case 35668:case 35672:return Pc;case 35669:case 35673:return Fc;case 5125:return Ic;case 36294:return Lc;case 36295:return Rc;case 36296:return zc;case 35678:case 36198:case 36298:case 36306:case 35682:return Vc;case 35679:case 36299:case 36307:return Hc;case 35680:case 36300:case 36308:case 36293:return Uc;case 36289:case 36303:case 36311:case 36292:return Wc}}function Kc(e,t){e.uniform1fv(this.addr,t)}function qc(e,t){let n=xc(t,this.size,2);e.uniform2fv(this.addr,n)}function Jc(e,t){let n=xc(t,this.size,3);e.uniform3fv(this.addr,n)}function Yc(e,t){let n=xc(t,this.size,4);e.uniform4fv(this.addr,n)}function Xc(e,t){let n=xc(t,this.size,4);e.uniformMatrix2fv(this.addr,!1,n)}function Zc(e,t){let n=xc(t,this.size,9);e.uniformMatrix3fv(this.addr,!1,n)}function Qc(e,t){let n=xc(t,this.size,16);e.uniformMatrix4fv(this.addr,!1,n)}function $c(e,t){e.uniform1iv(this.addr,t)}function el(e,t){e.uniform2iv(this.addr,t)}function tl(e,t){e.uniform3iv(this.addr,t)}function nl(e,t){e.uniform4iv(this.addr,t)}function rl(e,t){e.uniform1uiv(this.addr,t)}function il(e,t){e.uniform2uiv(this.addr,t)}function al(e,t){e.uniform3uiv(this.addr,t)}function ol(e,t){e.uniform4uiv(this.addr,t)}function sl(e,t,n){let r=this.cache,i=t.length,a=wc(n,i);Sc(r,a)||(e.uniform1iv(this.addr,a),Cc(r,a));let o;o=this.type===e.SAMPLER_2D_SHADOW?Bc(dc):uc;for(let e=0;e!==i;++e)n.setTexture2D(t[e]||o,a[e])}function cl(e,t,n){let r=this.cache,i=t.length,a=wc(n,i);Sc(r,a)||(e.uniform1iv(this.addr,a),Cc(r,a));for(let e=0;e!==i;++e)n.setTexture3D(t[e]||mc,a[e])}function ll(e,t,n){let r=this.cache,i=t.length,a=wc(n,i);Sc(r,a)||(e.uniform1iv(this.addr,a),Cc(r,a));let o;o=this.type===e.SAMPLER_CUBE_SHADOW?Bc(fc):hc;for(let e=0;e!==i;++e)n.setTextureCube(t[e]||o,a[e])}function ul(e,t,n){let r=this.cache,i=t.length,a=wc(n,i);Sc(r,a)||(e.uniform1iv(this.addr,a),Cc(r,a));for(let e=0;e!==i;++e)n.setTexture2DArray(t[e]||pc,a[e])}function dl(e){switch(e){case 5126:return Kc;case 35664:return qc;case 35665:return Jc;case 35666:return Yc;case 35674:return Xc;case 35675:return Zc;case 35676:return Qc;case 5124:case 35670:return $c;case 35667:case 35671:return el;case 35668:case 35672:return tl;case 35669:case 35673:return nl;case 5125:return rl;case 36294:return il;case 36295:return al;case 36296:return ol;case 35678:case 36198:case 36298:case 36306:case 35682:return sl;case 35679:case 36299:case 36307:return cl;case 35680:case 36300:case 36308:case 36293:return ll;case 36289:case 36303:case 36311:case 36292:return ul}}var fl=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.setValue=Gc(t.type)}},pl=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.size=t.size,this.setValue=dl(t.type)}},ml=class{constructor(e){this.id=e,this.seq=[],this.map={}}setValue(e,t,n){let r=this.seq;for(let i=0,a=r.length;i!==a;++i){let a=r[i];a.setValue(e,t[a.id],n)}}},hl=/(\w+)(\])?(\[|\.)?/g;function gl(e,t){e.seq.push(t),e.map[t.id]=t}function _l(e,t,n){let r=e.name,i=r.length;for(hl.lastIndex=0;;){let a=hl.exec(r),o=hl.lastIndex,s=a[1],c=a[2]===`]`,l=a[3];if(c&&(s|=0),l===void 0||l===`[`&&o+2===i){gl(n,l===void 0?new fl(s,e,t):new pl(s,e,t));break}{let e=n.map[s];e===void 0&&(e=new ml(s),gl(n,e)),n=e}}}var vl=class{constructor(e,t){this.seq=[],this.map={};let n=e.getProgramParameter(t,e.ACTIVE_UNIFORMS);for(let r=0;r<n;++r){let n=e.getActiveUniform(t,r);_l(n,e.getUniformLocation(t,n.name),this)}let r=[],i=[];for(let t of this.seq)t.type===e.SAMPLER_2D_SHADOW||t.type===e.SAMPLER_CUBE_SHADOW||t.type===e.SAMPLER_2D_ARRAY_SHADOW?r.push(t):i.push(t);r.length>0&&(this.seq=r.concat(i))}setValue(e,t,n,r){let i=this.map[t];i!==void 0&&i.setValue(e,n,r)}setOptional(e,t,n){let r=t[n];r!==void 0&&this.setValue(e,n,r)}static upload(e,t,n,r){for(let i=0,a=t.length;i!==a;++i){let a=t[i],o=n[a.id];o.needsUpdate!==!1&&a.setValue(e,o.value,r)}}static seqWithValue(e,t){let n=[];for(let r=0,i=e.length;r!==i;++r){let i=e[r];i.id in t&&n.push(i)}return n}};function yl(e,t,n){let r=e.createShader(t);return e.shaderSource(r,n),e.compileShader(r),r}var bl=37297,xl=0;function Sl(e,t){let n=e.split(`
`),r=[],i=Math.max(t-6,0),a=Math.min(t+6,n.length);for(let e=i;e<a;e++){let i=e+1;r.push(`${i===t?`>`:` `} ${i}: ${n[e]}`)}return r.join(`
`)}var Cl=new Y;function wl(e){X._getMatrix(Cl,X.workingColorSpace,e);let t=`mat3( ${Cl.elements.map(e=>e.toFixed(4))} )`;switch(X.getTransfer(e)){case Wn:return[t,`LinearTransferOETF`];case Gn:return[t,`sRGBTransferOETF`];default:return W(`WebGLProgram: Unsupported color space: `,e),[t,`LinearTransferOETF`]}}function Tl(e,t,n){let r=e.getShaderParameter(t,e.COMPILE_STATUS),i=(e.getShaderInfoLog(t)||``).trim();if(r&&i===``)return``;let a=/ERROR: 0:(\d+)/.exec(i);if(a){let r=parseInt(a[1]);return n.toUpperCase()+`

`+i+`

`+Sl(e.getShaderSource(t),r)}return i}function El(e,t){let n=wl(t);return[`vec4 ${e}( vec4 value ) {`,`	return ${n[1]}( vec4( ${n[0]} * value.rgb, value.a ) );`,`}`].join(`
`)}var Dl={1:`Linear`,2:`Reinhard`,3:`Cineon`,4:`ACESFilmic`,6:`AgX`,7:`Neutral`,5:`Custom`};function Ol(e,t){let n=Dl[t];return n===void 0?(W(`WebGLProgram: Unsupported toneMapping:`,t),`vec3 `+e+`( vec3 color ) { return LinearToneMapping( color ); }`):`vec3 `+e+`( vec3 color ) { return `+n+`ToneMapping( color ); }`}var kl=new J;function Al(){return X.getLuminanceCoefficients(kl),[`float luminance( const in vec3 rgb ) {`,`	const vec3 weights = vec3( ${kl.x.toFixed(4)}, ${kl.y.toFixed(4)}, ${kl.z.toFixed(4)} );`,`	return dot( weights, rgb );`,`}`].join(`
`)}function jl(e){return[e.extensionClipCullDistance?`#extension GL_ANGLE_clip_cull_distance : require`:``,e.extensionMultiDraw?`#extension GL_ANGLE_multi_draw : require`:``].filter(Pl).join(`
`)}function Ml(e){let t=[];for(let n in e){let r=e[n];r!==!1&&t.push(`#define `+n+` `+r)}return t.join(`
`)}function Nl(e,t){let n={},r=e.getProgramParameter(t,e.ACTIVE_ATTRIBUTES);for(let i=0;i<r;i++){let r=e.getActiveAttrib(t,i),a=r.name,o=1;r.type===e.FLOAT_MAT2&&(o=2),r.type===e.FLOAT_MAT3&&(o=3),r.type===e.FLOAT_MAT4&&(o=4),n[a]={type:r.type,location:e.getAttribLocation(t,a),locationSize:o}}return n}function Pl(e){return e!==``}function Fl(e,t){let n=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return e.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,n).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function Il(e,t){return e.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var Ll=/^[ \t]*#include +<([\w\d./]+)>/gm;function Rl(e){return e.replace(Ll,zl)}function zl(e,t){let n=Q[t];if(n===void 0)throw Error(`THREE.WebGLProgram: Can not resolve #include <`+t+`>`);return Rl(n)}var Bl=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Vl(e){return e.replace(Bl,Hl)}function Hl(e,t,n,r){let i=``;for(let e=parseInt(t);e<parseInt(n);e++)i+=r.replace(/\[\s*i\s*\]/g,`[ `+e+` ]`).replace(/UNROLLED_LOOP_INDEX/g,e);return i}function Ul(e){let t=`precision ${e.precision} float;
	precision ${e.precision} int;
	precision ${e.precision} sampler2D;
	precision ${e.precision} samplerCube;
	precision ${e.precision} sampler3D;
	precision ${e.precision} sampler2DArray;
	precision ${e.precision} sampler2DShadow;
	precision ${e.precision} samplerCubeShadow;
	precision ${e.precision} sampler2DArrayShadow;
	precision ${e.precision} isampler2D;
	precision ${e.precision} isampler3D;
	precision ${e.precision} isamplerCube;
	precision ${e.precision} isampler2DArray;
	precision ${e.precision} usampler2D;
	precision ${e.precision} usampler3D;
	precision ${e.precision} usamplerCube;
	precision ${e.precision} usampler2DArray;
	`;return e.precision===`highp`?t+=`
#define HIGH_PRECISION`:e.precision===`mediump`?t+=`
#define MEDIUM_PRECISION`:e.precision===`lowp`&&(t+=`
#define LOW_PRECISION`),t}var Wl={1:`SHADOWMAP_TYPE_PCF`,3:`SHADOWMAP_TYPE_VSM`};function Gl(e){return Wl[e.shadowMapType]||`SHADOWMAP_TYPE_BASIC`}var Kl={302:`ENVMAP_MODE_REFRACTION`};function ql(e){return e.envMap===!1?`ENVMAP_MODE_REFLECTION`:Kl[e.envMapMode]||`ENVMAP_MODE_REFLECTION`}var Jl={0:`ENVMAP_BLENDING_MULTIPLY`,1:`ENVMAP_BLENDING_MIX`,2:`ENVMAP_BLENDING_ADD`};function Yl(e){return e.envMap===!1?`ENVMAP_BLENDING_NONE`:Jl[e.combine]||`ENVMAP_BLENDING_NONE`}function Xl(e,t,n,r){let i=e.getContext(),a=n.defines,o=n.vertexShader,s=n.fragmentShader,c=Gl(n),l=n.envMapPMREM===!0?`ENVMAP_TYPE_PMREM`:`ENVMAP_TYPE_CUBE`,u=ql(n),d=Yl(n),f=jl(n),p=Ml(a),m=i.createProgram(),h,g,_=n.glslVersion?`#version `+n.glslVersion+`
`:``;n.isRawShaderMaterial?(h=[`#define SHADER_TYPE `+n.shaderType,`#define SHADER_NAME `+n.shaderName,p].filter(Pl).join(`
`),h.length>0&&(h+=`
`),g=[`#define SHADER_TYPE `+n.shaderType,`#define SHADER_NAME `+n.shaderName,p].filter(Pl).join(`
`),g.length>0&&(g+=`
`)):(h=[Ul(n),`#define SHADER_TYPE `+n.shaderType,`#define SHADER_NAME `+n.shaderName,p,n.extensionClipCullDistance?`#define USE_CLIP_DISTANCE`:``,n.batching?`#define USE_BATCHING`:``,n.batchingColor?`#define USE_BATCHING_COLOR`:``,n.instancing?`#define USE_INSTANCING`:``,n.instancingColor?`#define USE_INSTANCING_COLOR`:``,n.instancingMorph?`#define USE_INSTANCING_MORPH`:``,n.useFog&&n.fog?`#define USE_FOG`:``,n.useFog&&n.fogExp2?`#define FOG_EXP2`:``,n.map?`#define USE_MAP`:``,n.envMap?`#define USE_ENVMAP`:``,n.envMap?`#define `+u:``,n.lightMap?`#define USE_LIGHTMAP`:``,n.aoMap?`#define USE_AOMAP`:``,n.bumpMap?`#define USE_BUMPMAP`:``,n.normalMap?`#define USE_NORMALMAP`:``,n.normalMapObjectSpace?`#define USE_NORMALMAP_OBJECTSPACE`:``,n.normalMapTangentSpace?`#define USE_NORMALMAP_TANGENTSPACE`:``,n.displacementMap?`#define USE_DISPLACEMENTMAP`:``,n.emissiveMap?`#define USE_EMISSIVEMAP`:``,n.anisotropy?`#define USE_ANISOTROPY`:``,n.anisotropyMap?`#define USE_ANISOTROPYMAP`:``,n.clearcoatMap?`#define USE_CLEARCOATMAP`:``,n.clearcoatRoughnessMap?`#define USE_CLEARCOAT_ROUGHNESSMAP`:``,n.clearcoatNormalMap?`#define USE_CLEARCOAT_NORMALMAP`:``,n.diffuseRoughnessMap?`#define USE_DIFFUSE_ROUGHNESSMAP`:``,n.iridescenceMap?`#define USE_IRIDESCENCEMAP`:``,n.iridescenceThicknessMap?`#define USE_IRIDESCENCE_THICKNESSMAP`:``,n.specularMap?`#define USE_SPECULARMAP`:``,n.specularColorMap?`#define USE_SPECULAR_COLORMAP`:``,n.specularIntensityMap?`#define USE_SPECULAR_INTENSITYMAP`:``,n.roughnessMap?`#define USE_ROUGHNESSMAP`:``,n.metalnessMap?`#define USE_METALNESSMAP`:``,n.alphaMap?`#define USE_ALPHAMAP`:``,n.alphaHash?`#define USE_ALPHAHASH`:``,n.transmission?`#define USE_TRANSMISSION`:``,n.transmissionMap?`#define USE_TRANSMISSIONMAP`:``,n.thicknessMap?`#define USE_THICKNESSMAP`:``,n.sheenColorMap?`#define USE_SHEEN_COLORMAP`:``,n.sheenRoughnessMap?`#define USE_SHEEN_ROUGHNESSMAP`:``,n.mapUv?`#define MAP_UV `+n.mapUv:``,n.alphaMapUv?`#define ALPHAMAP_UV `+n.alphaMapUv:``,n.lightMapUv?`#define LIGHTMAP_UV `+n.lightMapUv:``,n.aoMapUv?`#define AOMAP_UV `+n.aoMapUv:``,n.emissiveMapUv?`#define EMISSIVEMAP_UV `+n.emissiveMapUv:``,n.bumpMapUv?`#define BUMPMAP_UV `+n.bumpMapUv:``,n.normalMapUv?`#define NORMALMAP_UV `+n.normalMapUv:``,n.displacementMapUv?`#define DISPLACEMENTMAP_UV `+n.displacementMapUv:``,n.metalnessMapUv?`#define METALNESSMAP_UV `+n.metalnessMapUv:``,n.roughnessMapUv?`#define ROUGHNESSMAP_UV `+n.roughnessMapUv:``,n.anisotropyMapUv?`#define ANISOTROPYMAP_UV `+n.anisotropyMapUv:``,n.clearcoatMapUv?`#define CLEARCOATMAP_UV `+n.clearcoatMapUv:``,n.clearcoatNormalMapUv?`#define CLEARCOAT_NORMALMAP_UV `+n.clearcoatNormalMapUv:``,n.clearcoatRoughnessMapUv?`#define CLEARCOAT_ROUGHNESSMAP_UV `+n.clearcoatRoughnessMapUv:``,n.diffuseRoughnessMapUv?`#define DIFFUSE_ROUGHNESSMAP_UV `+n.diffuseRoughnessMapUv:``,n.iridescenceMapUv?`#define IRIDESCENCEMAP_UV `+n.iridescenceMapUv:``,n.iridescenceThicknessMapUv?`#define IRIDESCENCE_THICKNESSMAP_UV `+n.iridescenceThicknessMapUv:``,n.sheenColorMapUv?`#define SHEEN_COLORMAP_UV `+n.sheenColorMapUv:``,n.sheenRoughnessMapUv?`#define SHEEN_ROUGHNESSMAP_UV `+n.sheenRoughnessMapUv:``,n.specularMapUv?`#define SPECULARMAP_UV `+n.specularMapUv:``,n.specularColorMapUv?`#define SPECULAR_COLORMAP_UV `+n.specularColorMapUv:``,n.specularIntensityMapUv?`#define SPECULAR_INTENSITYMAP_UV `+n.specularIntensityMapUv:``,n.transmissionMapUv?`#define TRANSMISSIONMAP_UV `+n.transmissionMapUv:``,n.thicknessMapUv?`#define THICKNESSMAP_UV `+n.thicknessMapUv:``,n.vertexTangents&&n.flatShading===!1?`#define USE_TANGENT`:``,n.vertexNormals?`#define HAS_NORMAL`:``,n.vertexColors?`#define USE_COLOR`:``,n.vertexAlphas?`#define USE_COLOR_ALPHA`:``,n.vertexUv1s?`#define USE_UV1`:``,n.vertexUv2s?`#define USE_UV2`:``,n.vertexUv3s?`#define USE_UV3`:``,n.pointsUvs?`#define USE_POINTS_UV`:``,n.flatShading?`#define FLAT_SHADED`:``,n.skinning?`#define USE_SKINNING`:``,n.morphTargets?`#define USE_MORPHTARGETS`:``,n.morphNormals&&n.flatShading===!1?`#define USE_MORPHNORMALS`:``,n.morphColors?`#define USE_MORPHCOLORS`:``,n.morphTargetsCount>0?`#define MORPHTARGETS_TEXTURE_STRIDE `+n.morphTextureStride:``,n.morphTargetsCount>0?`#define MORPHTARGETS_COUNT `+n.morphTargetsCount:``,n.doubleSided?`#define DOUBLE_SIDED`:``,n.flipSided?`#define FLIP_SIDED`:``,n.shadowMapEnabled?`#define USE_SHADOWMAP`:``,n.shadowMapEnabled?`#define `+c:``,n.sizeAttenuation?`#define USE_SIZEATTENUATION`:``,n.numLightProbes>0?`#define USE_LIGHT_PROBES`:``,n.logarithmicDepthBuffer?`#define USE_LOGARITHMIC_DEPTH_BUFFER`:``,n.reversedDepthBuffer?`#define USE_REVERSED_DEPTH_BUFFER`:``,`uniform mat4 modelMatrix;`,`uniform mat4 modelViewMatrix;`,`uniform mat4 projectionMatrix;`,`uniform mat4 viewMatrix;`,`uniform mat3 normalMatrix;`,`uniform vec3 cameraPosition;`,`uniform bool isOrthographic;`,`#ifdef USE_INSTANCING`,`	attribute mat4 instanceMatrix;`,`#endif`,`#ifdef USE_INSTANCING_COLOR`,`	attribute vec3 instanceColor;`,`#endif`,`#ifdef USE_INSTANCING_MORPH`,`	uniform sampler2D morphTexture;`,`#endif`,`attribute vec3 position;`,`attribute vec3 normal;`,`attribute vec2 uv;`,`#ifdef USE_UV1`,`	attribute vec2 uv1;`,`#endif`,`#ifdef USE_UV2`,`	attribute vec2 uv2;`,`#endif`,`#ifdef USE_UV3`,`	attribute vec2 uv3;`,`#endif`,`#ifdef USE_TANGENT`,`	attribute vec4 tangent;`,`#endif`,`#if defined( USE_COLOR_ALPHA )`,`	attribute vec4 color;`,`#elif defined( USE_COLOR )`,`	attribute vec3 color;`,`#endif`,`#ifdef USE_SKINNING`,`	attribute vec4 skinIndex;`,`	attribute vec4 skinWeight;`,`#endif`,`
`].filter(Pl).join(`
`),g=[Ul(n),`#define SHADER_TYPE `+n.shaderType,`#define SHADER_NAME `+n.shaderName,p,n.useFog&&n.fog?`#define USE_FOG`:``,n.useFog&&n.fogExp2?`#define FOG_EXP2`:``,n.alphaToCoverage?`#define ALPHA_TO_COVERAGE`:``,n.map?`#define USE_MAP`:``,n.matcap?`#define USE_MATCAP`:``,n.envMap?`#define USE_ENVMAP`:``,n.envMap?`#define `+l:``,n.envMap?`#define `+u:``,n.envMap?`#define `+d:``,n.envMapPMREM?`#define ENVMAP_MAX_LOD `+n.envMapMaxLod+`.0`:``,n.envMapPMREM?`#define ENVMAP_SIZE `+n.envMapSize+`.0`:``,n.lightMap?`#define USE_LIGHTMAP`:``,n.aoMap?`#define USE_AOMAP`:``,n.bumpMap?`#define USE_BUMPMAP`:``,n.normalMap?`#define USE_NORMALMAP`:``,n.normalMapObjectSpace?`#define USE_NORMALMAP_OBJECTSPACE`:``,n.normalMapTangentSpace?`#define USE_NORMALMAP_TANGENTSPACE`:``,n.packedNormalMap?`#define USE_PACKED_NORMALMAP`:``,n.emissiveMap?`#define USE_EMISSIVEMAP`:``,n.anisotropy?`#define USE_ANISOTROPY`:``,n.anisotropyMap?`#define USE_ANISOTROPYMAP`:``,n.clearcoat?`#define USE_CLEARCOAT`:``,n.clearcoatMap?`#define USE_CLEARCOATMAP`:``,n.clearcoatRoughnessMap?`#define USE_CLEARCOAT_ROUGHNESSMAP`:``,n.clearcoatNormalMap?`#define USE_CLEARCOAT_NORMALMAP`:``,n.diffuseRoughness?`#define USE_DIFFUSE_ROUGHNESS`:``,n.diffuseRoughnessMap?`#define USE_DIFFUSE_ROUGHNESSMAP`:``,n.dispersion?`#define USE_DISPERSION`:``,n.retroreflection?`#define USE_RETROREFLECTION`:``,n.iridescence?`#define USE_IRIDESCENCE`:``,n.iridescenceMap?`#define USE_IRIDESCENCEMAP`:``,n.iridescenceThicknessMap?`#define USE_IRIDESCENCE_THICKNESSMAP`:``,n.specularMap?`#define USE_SPECULARMAP`:``,n.specularColorMap?`#define USE_SPECULAR_COLORMAP`:``,n.specularIntensityMap?`#define USE_SPECULAR_INTENSITYMAP`:``,n.roughnessMap?`#define USE_ROUGHNESSMAP`:``,n.metalnessMap?`#define USE_METALNESSMAP`:``,n.alphaMap?`#define USE_ALPHAMAP`:``,n.alphaTest?`#define USE_ALPHATEST`:``,n.alphaHash?`#define USE_ALPHAHASH`:``,n.sheen?`#define USE_SHEEN`:``,n.sheenColorMap?`#define USE_SHEEN_COLORMAP`:``,n.sheenRoughnessMap?`#define USE_SHEEN_ROUGHNESSMAP`:``,n.transmission?`#define USE_TRANSMISSION`:``,n.transmissionMap?`#define USE_TRANSMISSIONMAP`:``,n.thicknessMap?`#define USE_THICKNESSMAP`:``,n.vertexTangents&&n.flatShading===!1?`#define USE_TANGENT`:``,n.vertexColors||n.instancingColor?`#define USE_COLOR`:``,n.vertexAlphas||n.batchingColor?`#define USE_COLOR_ALPHA`:``,n.vertexUv1s?`#define USE_UV1`:``,n.vertexUv2s?`#define USE_UV2`:``,n.vertexUv3s?`#define USE_UV3`:``,n.pointsUvs?`#define USE_POINTS_UV`:``,n.gradientMap?`#define USE_GRADIENTMAP`:``,n.flatShading?`#define FLAT_SHADED`:``,n.doubleSided?`#define DOUBLE_SIDED`:``,n.flipSided?`#define FLIP_SIDED`:``,n.shadowMapEnabled?`#define USE_SHADOWMAP`:``,n.shadowMapEnabled?`#define `+c:``,n.premultipliedAlpha?`#define PREMULTIPLIED_ALPHA`:``,n.numLightProbes>0?`#define USE_LIGHT_PROBES`:``,n.decodeVideoTexture?`#define DECODE_VIDEO_TEXTURE`:``,n.decodeVideoTextureEmissive?`#define DECODE_VIDEO_TEXTURE_EMISSIVE`:``,n.logarithmicDepthBuffer?`#define USE_LOGARITHMIC_DEPTH_BUFFER`:``,n.reversedDepthBuffer?`#define USE_REVERSED_DEPTH_BUFFER`:``,`uniform mat4 viewMatrix;`,`uniform vec3 cameraPosition;`,`uniform bool isOrthographic;`,n.toneMapping===0?``:`#define TONE_MAPPING`,n.toneMapping===0?``:Q.tonemapping_pars_fragment,n.toneMapping===0?``:Ol(`toneMapping`,n.toneMapping),n.dithering?`#define DITHERING`:``,n.opaque?`#define OPAQUE`:``,Q.colorspace_pars_fragment,El(`linearToOutputTexel`,n.outputColorSpace),Al(),n.useDepthPacking?`#define DEPTH_PACKING `+n.depthPacking:``,`
`].filter(Pl).join(`
`)),o=Rl(o),o=Fl(o,n),o=Il(o,n),s=Rl(s),s=Fl(s,n),s=Il(s,n),o=Vl(o),s=Vl(s),n.isRawShaderMaterial!==!0&&(_=`#version 300 es
`,h=[f,`#define attribute in`,`#define varying out`,`#define texture2D texture`].join(`
`)+`
`+h,g=[`#define varying in`,n.glslVersion===`300 es`?``:`layout(location = 0) out highp vec4 pc_fragColor;`,n.glslVersion===`300 es`?``:`#define gl_FragColor pc_fragColor`,`#define gl_FragDepthEXT gl_FragDepth`,`#define texture2D texture`,`#define textureCube texture`,`#define texture2DProj textureProj`,`#define texture2DLodEXT textureLod`,`#define texture2DProjLodEXT textureProjLod`,`#define textureCubeLodEXT textureLod`,`#define texture2DGradEXT textureGrad`,`#define texture2DProjGradEXT textureProjGrad`,`#define textureCubeGradEXT textureGrad`].join(`
`)+`
`+g);let v=_+h+o,y=_+g+s,b=yl(i,i.VERTEX_SHADER,v),x=yl(i,i.FRAGMENT_SHADER,y);i.attachShader(m,b),i.attachShader(m,x),n.index0AttributeName===void 0?n.hasPositionAttribute===!0&&i.bindAttribLocation(m,0,`position`):i.bindAttribLocation(m,0,n.index0AttributeName),i.linkProgram(m);function S(t){if(e.debug.checkShaderErrors){let n=i.getProgramInfoLog(m)||``,r=i.getShaderInfoLog(b)||``,a=i.getShaderInfoLog(x)||``,o=n.trim(),s=r.trim(),c=a.trim(),l=!0,u=!0;if(i.getProgramParameter(m,i.LINK_STATUS)===!1){if(l=!1,typeof e.debug.onShaderError==`function`)e.debug.onShaderError(i,m,b,x);else{let e=Tl(i,b,`vertex`),n=Tl(i,x,`fragment`);G(`WebGLProgram: Shader Error `+i.getError()+` - VALIDATE_STATUS `+i.getProgramParameter(m,i.VALIDATE_STATUS)+`

Material Name: `+t.name+`
Material Type: `+t.type+`

Program Info Log: `+o+`
`+e+`
`+n)}}else o===``?(s===``||c===``)&&(u=!1):W(`WebGLProgram: Program Info Log:`,o);u&&(t.diagnostics={runnable:l,programLog:o,vertexShader:{log:s,prefix:h},fragmentShader:{log:c,prefix:g}})}i.deleteShader(b),i.deleteShader(x),C=new vl(i,m),w=Nl(i,m)}let C;this.getUniforms=function(){return C===void 0&&S(this),C};let w;this.getAttributes=function(){return w===void 0&&S(this),w};let T=n.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return T===!1&&(T=i.getProgramParameter(m,bl)),T},this.destroy=function(){r.releaseStatesOfProgram(this),i.deleteProgram(m),this.program=void 0},this.type=n.shaderType,this.name=n.shaderName,this.id=xl++,this.cacheKey=t,this.usedTimes=1,this.program=m,this.vertexShader=b,this.fragmentShader=x,this}var Zl=0,Ql=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(e,t,n){let r=this._getShaderCacheForMaterial(e);return r.has(t)===!1&&(r.add(t),t.usedTimes++),r.has(n)===!1&&(r.add(n),n.usedTimes++),this}remove(e){let t=this.materialCache.get(e);for(let e of t)e.usedTimes--,e.usedTimes===0&&this.shaderCache.delete(e.code);return this.materialCache.delete(e),this}getVertexShaderStage(e){return this._getShaderStage(e.vertexShader)}getFragmentShaderStage(e){return this._getShaderStage(e.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(e){let t=this.materialCache,n=t.get(e);return n===void 0&&(n=new Set,t.set(e,n)),n}_getShaderStage(e){let t=this.shaderCache,n=t.get(e);return n===void 0&&(n=new $l(e),t.set(e,n)),n}},$l=class{constructor(e){this.id=Zl++,this.code=e,this.usedTimes=0}};function eu(e){return e===1030||e===37490||e===36285}function tu(e,t,n,r,i,a){let o=new Xr,s=new Ql,c=new Set,l=[],u=new Map,d=r.logarithmicDepthBuffer,f={MeshDepthMaterial:`depth`,MeshDistanceMaterial:`distance`,MeshNormalMaterial:`normal`,MeshBasicMaterial:`basic`,MeshLambertMaterial:`lambert`,MeshPhongMaterial:`phong`,MeshToonMaterial:`toon`,MeshStandardMaterial:`physical`,MeshPhysicalMaterial:`physical`,MeshMatcapMaterial:`matcap`,LineBasicMaterial:`basic`,LineDashedMaterial:`dashed`,PointsMaterial:`points`,ShadowMaterial:`shadow`,SpriteMaterial:`sprite`};function p(e){return c.add(e),e===0?`uv`:`uv${e}`}function m(i,o,l,u,m,h){let g=u.fog,_=m.geometry,v=i.isMeshStandardMaterial||i.isMeshLambertMaterial||i.isMeshPhongMaterial?u.environment:null,y=i.isMeshStandardMaterial||i.isMeshLambertMaterial&&!i.envMap||i.isMeshPhongMaterial&&!i.envMap,b=t.get(i.envMap||v,y),x=f[i.type],S=r.precision;i.precision!==null&&(S=r.getMaxPrecision(i.precision),S!==i.precision&&W(`WebGLProgram.getParameters:`,i.precision,`not supported, using`,S,`instead.`));let C=_.morphAttributes.position||_.morphAttributes.normal||_.morphAttributes.color,w=C===void 0?0:C.length,T=0;_.morphAttributes.position!==void 0&&(T=1),_.morphAttributes.normal!==void 0&&(T=2),_.morphAttributes.color!==void 0&&(T=3);let E,D,O,k;if(x){let e=ks[x];E=e.vertexShader,D=e.fragmentShader}else{E=i.vertexShader,D=i.fragmentShader;let e=s.getVertexShaderStage(i),t=s.getFragmentShaderStage(i);s.update(i,e,t),O=e.id,k=t.id}let A=e.getRenderTarget(),j=e.state.buffers.depth.getReversed(),M=m.isInstancedMesh===!0,N=m.isBatchedMesh===!0,P=!!i.map,F=!!i.matcap,I=!!b,ee=I&&b.isPMREMTexture===!0,te=!!i.aoMap,ne=!!i.lightMap,re=!!i.bumpMap&&i.wireframe===!1,ie=!!i.normalMap,ae=!!i.displacementMap,L=!!i.emissiveMap,oe=!!i.metalnessMap,R=!!i.roughnessMap,se=i.anisotropy>0,ce=i.clearcoat>0,le=i.diffuseRoughness>0,ue=i.dispersion>0,de=i.retroreflectivity>0,fe=i.iridescence>0,pe=i.sheen>0,me=i.transmission>0,he=se&&!!i.anisotropyMap,ge=ce&&!!i.clearcoatMap,_e=ce&&!!i.clearcoatNormalMap,ve=ce&&!!i.clearcoatRoughnessMap,ye=le&&!!i.diffuseRoughnessMap,z=fe&&!!i.iridescenceMap,be=fe&&!!i.iridescenceThicknessMap,xe=pe&&!!i.sheenColorMap,Se=pe&&!!i.sheenRoughnessMap,B=!!i.specularMap,Ce=!!i.specularColorMap,V=!!i.specularIntensityMap,H=me&&!!i.transmissionMap,we=me&&!!i.thicknessMap,Te=!!i.gradientMap,Ee=!!i.alphaMap,De=i.alphaTest>0,U=!!i.alphaHash,Oe=!!i.extensions,ke=0;i.toneMapped&&(A===null||A.isXRRenderTarget===!0)&&(ke=e.toneMapping);let Ae=ee?b.isCompressedCubeTexture?b.image[0].mipmaps:b.mipmaps:null,je={shaderID:x,shaderType:i.type,shaderName:i.name,vertexShader:E,fragmentShader:D,defines:i.defines,customVertexShaderID:O,customFragmentShaderID:k,isRawShaderMaterial:i.isRawShaderMaterial===!0,glslVersion:i.glslVersion,precision:S,batching:N,batchingColor:N&&m._colorsTexture!==null,instancing:M,instancingColor:M&&m.instanceColor!==null,instancingMorph:M&&m.morphTexture!==null,outputColorSpace:A===null?e.outputColorSpace:A.isXRRenderTarget===!0?A.texture.colorSpace:X.workingColorSpace,alphaToCoverage:!!i.alphaToCoverage,map:P,matcap:F,envMap:I,envMapMode:I&&b.mapping,envMapPMREM:ee,envMapMaxLod:ee?Ae.length-1:null,envMapSize:ee?Ae[0].width:null,aoMap:te,lightMap:ne,bumpMap:re,normalMap:ie,displacementMap:ae,emissiveMap:L,normalMapObjectSpace:ie&&i.normalMapType===1,normalMapTangentSpace:ie&&i.normalMapType===0,packedNormalMap:ie&&i.normalMapType===0&&eu(i.normalMap.format),metalnessMap:oe,roughnessMap:R,anisotropy:se,anisotropyMap:he,clearcoat:ce,clearcoatMap:ge,clearcoatNormalMap:_e,clearcoatRoughnessMap:ve,diffuseRoughness:le,diffuseRoughnessMap:ye,dispersion:ue,retroreflection:de,iridescence:fe,iridescenceMap:z,iridescenceThicknessMap:be,sheen:pe,sheenColorMap:xe,sheenRoughnessMap:Se,specularMap:B,specularColorMap:Ce,specularIntensityMap:V,transmission:me,transmissionMap:H,thicknessMap:we,gradientMap:Te,opaque:i.transparent===!1&&i.blending===1&&i.alphaToCoverage===!1,alphaMap:Ee,alphaTest:De,alphaHash:U,combine:i.combine,mapUv:P&&p(i.map.channel),aoMapUv:te&&p(i.aoMap.channel),lightMapUv:ne&&p(i.lightMap.channel),bumpMapUv:re&&p(i.bumpMap.channel),normalMapUv:ie&&p(i.normalMap.channel),displacementMapUv:ae&&p(i.displacementMap.channel),emissiveMapUv:L&&p(i.emissiveMap.channel),metalnessMapUv:oe&&p(i.metalnessMap.channel),roughnessMapUv:R&&p(i.roughnessMap.channel),anisotropyMapUv:he&&p(i.anisotropyMap.channel),clearcoatMapUv:ge&&p(i.clearcoatMap.channel),clearcoatNormalMapUv:_e&&p(i.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:ve&&p(i.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:ye&&p(i.diffuseRoughnessMap.channel),iridescenceMapUv:z&&p(i.iridescenceMap.channel),iridescenceThicknessMapUv:be&&p(i.iridescenceThicknessMap.channel),sheenColorMapUv:xe&&p(i.sheenColorMap.channel),sheenRoughnessMapUv:Se&&p(i.sheenRoughnessMap.channel),specularMapUv:B&&p(i.specularMap.channel),specularColorMapUv:Ce&&p(i.specularColorMap.channel),specularIntensityMapUv:V&&p(i.specularIntensityMap.channel),transmissionMapUv:H&&p(i.transmissionMap.channel),thicknessMapUv:we&&p(i.thicknessMap.channel),alphaMapUv:Ee&&p(i.alphaMap.channel),vertexTangents:!!_.attributes.tangent&&(ie||se),vertexNormals:!!_.attributes.normal,vertexColors:i.vertexColors,vertexAlphas:i.vertexColors===!0&&!!_.attributes.color&&_.attributes.color.itemSize===4,pointsUvs:m.isPoints===!0&&!!_.attributes.uv&&(P||Ee),fog:!!g,useFog:i.fog===!0,fogExp2:!!g&&g.isFogExp2,flatShading:i.wireframe===!1&&(i.flatShading===!0||_.attributes.normal===void 0&&ie===!1&&(i.isMeshLambertMaterial||i.isMeshPhongMaterial||i.isMeshStandardMaterial||i.isMeshPhysicalMaterial)),sizeAttenuation:i.sizeAttenuation===!0,logarithmicDepthBuffer:d,reversedDepthBuffer:j,skinning:m.isSkinnedMesh===!0,hasPositionAttribute:_.attributes.position!==void 0,morphTargets:_.morphAttributes.position!==void 0,morphNormals:_.morphAttributes.normal!==void 0,morphColors:_.morphAttributes.color!==void 0,morphTargetsCount:w,morphTextureStride:T,numSunLights:o.sun.length,numDirLights:o.directional.length,numPointLights:o.point.length,numSpotLights:o.spot.length,numSpotLightMaps:o.spotLightMap.length,numRectAreaLights:o.rectArea.length,numHemiLights:o.hemi.length,numSunLightShadows:o.sunShadowMap.length,numDirLightShadows:o.directionalShadowMap.length,numPointLightShadows:o.pointShadowMap.length,numSpotLightShadows:o.spotShadowMap.length,numSpotLightShadowsWithMaps:o.numSpotLightShadowsWithMaps,numLightProbes:o.numLightProbes,numLightProbeGrids:h.filter(e=>e.texture!==null).length,numClippingPlanes:a.numPlanes,numClipIntersection:a.numIntersection,dithering:i.dithering,shadowMapEnabled:e.shadowMap.enabled&&l.length>0,shadowMapType:e.shadowMap.type,toneMapping:ke,decodeVideoTexture:P&&i.map.isVideoTexture===!0&&X.getTransfer(i.map.colorSpace)===`srgb`,decodeVideoTextureEmissive:L&&i.emissiveMap.isVideoTexture===!0&&X.getTransfer(i.emissiveMap.colorSpace)===`srgb`,premultipliedAlpha:i.premultipliedAlpha,doubleSided:i.side===2,flipSided:i.side===1,useDepthPacking:i.depthPacking>=0,depthPacking:i.depthPacking||0,index0AttributeName:i.index0AttributeName,extensionClipCullDistance:Oe&&i.extensions.clipCullDistance===!0&&n.has(`WEBGL_clip_cull_distance`),extensionMultiDraw:(Oe&&i.extensions.multiDraw===!0||N)&&n.has(`WEBGL_multi_draw`),rendererExtensionParallelShaderCompile:n.has(`KHR_parallel_shader_compile`),customProgramCacheKey:i.customProgramCacheKey()};return je.vertexUv1s=c.has(1),je.vertexUv2s=c.has(2),je.vertexUv3s=c.has(3),c.clear(),je}function h(t){let n=[];if(t.shaderID?n.push(t.shaderID):(n.push(t.customVertexShaderID),n.push(t.customFragmentShaderID)),t.defines!==void 0)for(let e in t.defines)n.push(e),n.push(t.defines[e]);return t.isRawShaderMaterial===!1&&(g(n,t),_(n,t),n.push(e.outputColorSpace)),n.push(t.customProgramCacheKey),n.join()}function g(e,t){e.push(t.precision),e.push(t.outputColorSpace),e.push(t.envMapMode),e.push(t.envMapPMREM),e.push(t.envMapMaxLod),e.push(t.envMapSize),e.push(t.mapUv),e.push(t.alphaMapUv),e.push(t.lightMapUv),e.push(t.aoMapUv),e.push(t.bumpMapUv),e.push(t.normalMapUv),e.push(t.displacementMapUv),e.push(t.emissiveMapUv),e.push(t.metalnessMapUv),e.push(t.roughnessMapUv),e.push(t.anisotropyMapUv),e.push(t.clearcoatMapUv),e.push(t.clearcoatNormalMapUv),e.push(t.clearcoatRoughnessMapUv),e.push(t.diffuseRoughnessMapUv),e.push(t.iridescenceMapUv),e.push(t.iridescenceThicknessMapUv),e.push(t.sheenColorMapUv),e.push(t.sheenRoughnessMapUv),e.push(t.specularMapUv),e.push(t.specularColorMapUv),e.push(t.specularIntensityMapUv),e.push(t.transmissionMapUv),e.push(t.thicknessMapUv),e.push(t.combine),e.push(t.fogExp2),e.push(t.sizeAttenuation),e.push(t.morphTargetsCount),e.push(t.numSunLights),e.push(t.numDirLights),e.push(t.numPointLights),e.push(t.numSpotLights),e.push(t.numSpotLightMaps),e.push(t.numHemiLights),e.push(t.numRectAreaLights),e.push(t.numSunLightShadows),e.push(t.numDirLightShadows),e.push(t.numPointLightShadows),e.push(t.numSpotLightShadows),e.push(t.numSpotLightShadowsWithMaps),e.push(t.numLightProbes),e.push(t.numLightProbeGrids),e.push(t.shadowMapType),e.push(t.toneMapping),e.push(t.numClippingPlanes),e.push(t.numClipIntersection),e.push(t.depthPacking)}function _(e,t){o.disableAll(),t.instancing&&o.enable(0),t.instancingColor&&o.enable(1),t.instancingMorph&&o.enable(2),t.matcap&&o.enable(3),t.envMap&&o.enable(4),t.normalMapObjectSpace&&o.enable(5),t.normalMapTangentSpace&&o.enable(6),t.clearcoat&&o.enable(7),t.iridescence&&o.enable(8),t.alphaTest&&o.enable(9),t.vertexColors&&o.enable(10),t.vertexAlphas&&o.enable(11),t.vertexUv1s&&o.enable(12),t.vertexUv2s&&o.enable(13),t.vertexUv3s&&o.enable(14),t.vertexTangents&&o.enable(15),t.anisotropy&&o.enable(16),t.alphaHash&&o.enable(17),t.batching&&o.enable(18),t.dispersion&&o.enable(19),t.retroreflection&&o.enable(24),t.diffuseRoughness&&o.enable(25),t.batchingColor&&o.enable(20),t.gradientMap&&o.enable(21),t.packedNormalMap&&o.enable(22),t.vertexNormals&&o.enable(23),e.push(o.mask),o.disableAll(),t.fog&&o.enable(0),t.useFog&&o.enable(1),t.flatShading&&o.enable(2),t.logarithmicDepthBuffer&&o.enable(3),t.reversedDepthBuffer&&o.enable(4),t.skinning&&o.enable(5),t.morphTargets&&o.enable(6),t.morphNormals&&o.enable(7),t.morphColors&&o.enable(8),t.premultipliedAlpha&&o.enable(9),t.shadowMapEnabled&&o.enable(10),t.doubleSided&&o.enable(11),t.flipSided&&o.enable(12),t.useDepthPacking&&o.enable(13),t.dithering&&o.enable(14),t.transmission&&o.enable(15),t.sheen&&o.enable(16),t.opaque&&o.enable(17),t.pointsUvs&&o.enable(18),t.decodeVideoTexture&&o.enable(19),t.decodeVideoTextureEmissive&&o.enable(20),t.alphaToCoverage&&o.enable(21),t.numLightProbeGrids>0&&o.enable(22),t.hasPositionAttribute&&o.enable(23),e.push(o.mask)}function v(e){let t=f[e.type],n;if(t){let e=ks[t];n=Do.clone(e.uniforms)}else n=e.uniforms;return n}function y(t,n){let r=u.get(n);return r===void 0?(r=new Xl(e,n,t,i),l.push(r),u.set(n,r)):++r.usedTimes,r}function b(e){if(--e.usedTimes===0){let t=l.indexOf(e);l[t]=l[l.length-1],l.pop(),u.delete(e.cacheKey),e.destroy()}}function x(e){s.remove(e)}function S(){s.dispose()}return{getParameters:m,getProgramCacheKey:h,getUniforms:v,acquireProgram:y,releaseProgram:b,releaseShaderCache:x,programs:l,dispose:S}}function nu(){let e=new WeakMap;function t(t){return e.has(t)}function n(t){let n=e.get(t);return n===void 0&&(n={},e.set(t,n)),n}function r(t){e.delete(t)}function i(t,n,r){e.get(t)[n]=r}function a(){e=new WeakMap}return{has:t,get:n,remove:r,update:i,dispose:a}}function ru(e,t){return e.groupOrder===t.groupOrder?e.renderOrder===t.renderOrder?e.material.id===t.material.id?e.materialVariant===t.materialVariant?e.z===t.z?e.id-t.id:e.z-t.z:e.materialVariant-t.materialVariant:e.material.id-t.material.id:e.renderOrder-t.renderOrder:e.groupOrder-t.groupOrder}function iu(e,t){return e.groupOrder===t.groupOrder?e.renderOrder===t.renderOrder?e.z===t.z?e.id-t.id:t.z-e.z:e.renderOrder-t.renderOrder:e.groupOrder-t.groupOrder}function au(){let e=[],t=0,n=[],r=[],i=[];function a(){t=0,n.length=0,r.length=0,i.length=0}function o(e){let t=0;return e.isInstancedMesh&&(t+=2),e.isSkinnedMesh&&(t+=1),t}function s(n,r,i,a,s,c){let l=e[t];return l===void 0?(l={id:n.id,object:n,geometry:r,material:i,materialVariant:o(n),groupOrder:a,renderOrder:n.renderOrder,z:s,group:c},e[t]=l):(l.id=n.id,l.object=n,l.geometry=r,l.material=i,l.materialVariant=o(n),l.groupOrder=a,l.renderOrder=n.renderOrder,l.z=s,l.group=c),t++,l}function c(e,t,a,o,c,l,u){u.reversedDepth===!0&&(c=-c);let d=s(e,t,a,o,c,l);a.transmission>0?r.push(d):a.transparent===!0?i.push(d):n.push(d)}function l(e,t,a,o,c,l){let u=s(e,t,a,o,c,l);a.transmission>0?r.unshift(u):a.transparent===!0?i.unshift(u):n.unshift(u)}function u(e,t){n.length>1&&n.sort(e||ru),r.length>1&&r.sort(t||iu),i.length>1&&i.sort(t||iu)}function d(){for(let n=t,r=e.length;n<r;n++){let t=e[n];if(t.id===null)break;t.id=null,t.object=null,t.geometry=null,t.material=null,t.group=null}}return{opaque:n,transmissive:r,transparent:i,init:a,push:c,unshift:l,finish:d,sort:u}}function ou(){let e=new WeakMap;function t(t,n){let r=e.get(t),i;return r===void 0?(i=new au,e.set(t,[i])):n>=r.length?(i=new au,r.push(i)):i=r[n],i}function n(){e=new WeakMap}return{get:t,dispose:n}}function su(){let e={};return{get:function(t){if(e[t.id]!==void 0)return e[t.id];let n;switch(t.type){case`SunLight`:case`DirectionalLight`:n={direction:new J,color:new Z};break;case`SpotLight`:n={position:new J,direction:new J,color:new Z,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case`PointLight`:n={position:new J,color:new Z,distance:0,decay:0};break;case`HemisphereLight`:n={direction:new J,skyColor:new Z,groundColor:new Z};break;case`RectAreaLight`:n={color:new Z,position:new J,halfWidth:new J,halfHeight:new J}}return e[t.id]=n,n}}}function cu(){let e={};return{get:function(t){if(e[t.id]!==void 0)return e[t.id];let n;switch(t.type){case`SunLight`:case`DirectionalLight`:n={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new q};break;case`SpotLight`:n={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new q};break;case`PointLight`:n={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new q,shadowCameraNear:1,shadowCameraFar:1e3}}return e[t.id]=n,n}}}var lu=0;function uu(e,t){return(t.castShadow?2:0)-(e.castShadow?2:0)+ +!!t.map-!!e.map}function du(e){let t=new su,n=cu(),r={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let e=0;e<9;e++)r.probe.push(new J);let i=new J,a=new zr,o=new zr;function s(i){let a=0,o=0,s=0;for(let e=0;e<9;e++)r.probe[e].set(0,0,0);let c=0,l=0,u=0,d=0,f=0,p=0,m=0,h=0,g=0,_=0,v=0,y=0,b=0,x=0;i.sort(uu);for(let e=0,S=i.length;e<S;e++){let S=i[e],C=S.color,w=S.intensity,T=S.distance,E=null;if(S.shadow&&S.shadow.map&&(E=S.shadow.map.texture.format===1030?S.shadow.map.texture:S.shadow.map.depthTexture||S.shadow.map.texture),S.isAmbientLight)a+=C.r*w,o+=C.g*w,s+=C.b*w;else if(S.isLightProbe){for(let e=0;e<9;e++)r.probe[e].addScaledVector(S.sh.coefficients[e],w);x++}else if(S.isSunLight){let e=t.get(S);if(e.color.copy(S.color).multiplyScalar(S.intensity),S.castShadow){let e=S.shadow,t=n.get(S);t.shadowIntensity=e.intensity,t.shadowBias=e.bias,t.shadowNormalBias=e.normalBias,t.shadowRadius=e.radius,t.shadowMapSize.copy(e.mapSize).multiply(e.getFrameExtents()),r.sunShadow[l]=t,r.sunShadowMap[l]=E;let i=e.getViewportCount();for(let t=0;t<i;t++)r.sunShadowMatrix[u+t]=e.getMatrix(t),r.sunShadowCascade[u+t]=e._cascadeData[t];u+=i,l++}r.sun[c]=e,c++}else if(S.isDirectionalLight){let e=t.get(S);if(e.color.copy(S.color).multiplyScalar(S.intensity),S.castShadow){let e=S.shadow,t=n.get(S);t.shadowIntensity=e.intensity,t.shadowBias=e.bias,t.shadowNormalBias=e.normalBias,t.shadowRadius=e.radius,t.shadowMapSize=e.mapSize,r.directionalShadow[d]=t,r.directionalShadowMap[d]=E,r.directionalShadowMatrix[d]=S.shadow.matrix,g++}r.directional[d]=e,d++}else if(S.isSpotLight){let e=t.get(S);e.position.setFromMatrixPosition(S.matrixWorld),e.color.copy(C).multiplyScalar(w),e.distance=T,e.coneCos=Math.cos(S.angle),e.penumbraCos=Math.cos(S.angle*(1-S.penumbra)),e.decay=S.decay,r.spot[p]=e;let i=S.shadow;if(S.map&&(r.spotLightMap[y]=S.map,y++,i.updateMatrices(S),S.castShadow&&b++),r.spotLightMatrix[p]=i.matrix,S.castShadow){let e=n.get(S);e.shadowIntensity=i.intensity,e.shadowBias=i.bias,e.shadowNormalBias=i.normalBias,e.shadowRadius=i.radius,e.shadowMapSize=i.mapSize,r.spotShadow[p]=e,r.spotShadowMap[p]=E,v++}p++}else if(S.isRectAreaLight){let e=t.get(S);e.color.copy(C).multiplyScalar(w),e.halfWidth.set(S.width*.5,0,0),e.halfHeight.set(0,S.height*.5,0),r.rectArea[m]=e,m++}else if(S.isPointLight){let e=t.get(S);if(e.color.copy(S.color).multiplyScalar(S.intensity),e.distance=S.distance,e.decay=S.decay,S.castShadow){let e=S.shadow,t=n.get(S);t.shadowIntensity=e.intensity,t.shadowBias=e.bias,t.shadowNormalBias=e.normalBias,t.shadowRadius=e.radius,t.shadowMapSize=e.mapSize,t.shadowCameraNear=e.camera.near,t.shadowCameraFar=e.camera.far,r.pointShadow[f]=t,r.pointShadowMap[f]=E,r.pointShadowMatrix[f]=S.shadow.matrix,_++}r.point[f]=e,f++}else if(S.isHemisphereLight){let e=t.get(S);e.skyColor.copy(S.color).multiplyScalar(w),e.groundColor.copy(S.groundColor).multiplyScalar(w),r.hemi[h]=e,h++}}m>0&&(e.has(`OES_texture_float_linear`)===!0?(r.rectAreaLTC1=$.LTC_FLOAT_1,r.rectAreaLTC2=$.LTC_FLOAT_2):(r.rectAreaLTC1=$.LTC_HALF_1,r.rectAreaLTC2=$.LTC_HALF_2)),r.ambient[0]=a,r.ambient[1]=o,r.ambient[2]=s;let S=r.hash;(S.sunLength!==c||S.directionalLength!==d||S.pointLength!==f||S.spotLength!==p||S.rectAreaLength!==m||S.hemiLength!==h||S.numSunShadows!==l||S.numDirectionalShadows!==g||S.numPointShadows!==_||S.numSpotShadows!==v||S.numSpotMaps!==y||S.numLightProbes!==x)&&(r.sun.length=c,r.directional.length=d,r.spot.length=p,r.rectArea.length=m,r.point.length=f,r.hemi.length=h,r.sunShadow.length=l,r.sunShadowMap.length=l,r.sunShadowMatrix.length=u,r.sunShadowCascade.length=u,r.directionalShadow.length=g,r.directionalShadowMap.length=g,r.directionalShadowMatrix.length=g,r.pointShadow.length=_,r.pointShadowMap.length=_,r.pointShadowMatrix.length=_,r.spotShadow.length=v,r.spotShadowMap.length=v,r.spotLightMatrix.length=v+y-b,r.spotLightMap.length=y,r.numSpotLightShadowsWithMaps=b,r.numLightProbes=x,S.sunLength=c,S.directionalLength=d,S.pointLength=f,S.spotLength=p,S.rectAreaLength=m,S.hemiLength=h,S.numSunShadows=l,S.numDirectionalShadows=g,S.numPointShadows=_,S.numSpotShadows=v,S.numSpotMaps=y,S.numLightProbes=x,r.version=lu++)}function c(e,t){let n=0,s=0,c=0,l=0,u=0,d=0,f=t.matrixWorldInverse;for(let t=0,p=e.length;t<p;t++){let p=e[t];if(p.isSunLight){let e=r.sun[n];e.direction.setFromMatrixPosition(p.matrixWorld),e.direction.transformDirection(f),n++}else if(p.isDirectionalLight){let e=r.directional[s];e.direction.setFromMatrixPosition(p.matrixWorld),i.setFromMatrixPosition(p.target.matrixWorld),e.direction.sub(i),e.direction.transformDirection(f),s++}else if(p.isSpotLight){let e=r.spot[l];e.position.setFromMatrixPosition(p.matrixWorld),e.position.applyMatrix4(f),e.direction.setFromMatrixPosition(p.matrixWorld),i.setFromMatrixPosition(p.target.matrixWorld),e.direction.sub(i),e.direction.transformDirection(f),l++}else if(p.isRectAreaLight){let e=r.rectArea[u];e.position.setFromMatrixPosition(p.matrixWorld),e.position.applyMatrix4(f),o.identity(),a.copy(p.matrixWorld),a.premultiply(f),o.extractRotation(a),e.halfWidth.set(p.width*.5,0,0),e.halfHeight.set(0,p.height*.5,0),e.halfWidth.applyMatrix4(o),e.halfHeight.applyMatrix4(o),u++}else if(p.isPointLight){let e=r.point[c];e.position.setFromMatrixPosition(p.matrixWorld),e.position.applyMatrix4(f),c++}else if(p.isHemisphereLight){let e=r.hemi[d];e.direction.setFromMatrixPosition(p.matrixWorld),e.direction.transformDirection(f),d++}}}return{setup:s,setupView:c,state:r}}function fu(e){let t=new du(e),n=[],r=[],i=[];function a(e){u.camera=e,n.length=0,r.length=0,i.length=0}function o(e){e.isLightProbeGrid?i.push(e):n.push(e)}function s(e){r.push(e)}function c(){t.setup(n),i.sort((e,t)=>e.priority-t.priority||e.id-t.id)}function l(e){t.setupView(n,e)}let u={lightsArray:n,shadowsArray:r,lightProbeGridArray:i,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:a,state:u,setupLights:c,setupLightsView:l,pushLight:o,pushShadow:s}}function pu(e){let t=new WeakMap;function n(n,r=0){let i=t.get(n),a;return i===void 0?(a=new fu(e),t.set(n,[a])):r>=i.length?(a=new fu(e),i.push(a)):a=i[r],a}function r(){t=new WeakMap}return{get:n,dispose:r}}var mu=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,hu=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,gu=[new J(1,0,0),new J(-1,0,0),new J(0,1,0),new J(0,-1,0),new J(0,0,1),new J(0,0,-1)],_u=[new J(0,-1,0),new J(0,-1,0),new J(0,0,1),new J(0,0,-1),new J(0,-1,0),new J(0,-1,0)],vu=new zr,yu=new J,bu=new J;function xu(e,t,n){let r=new Ka,i=new q,a=new q,o=new Pr,s=new Mo,c=new No,l={},u=n.maxTextureSize,d={0:1,1:0,2:2},f=new Ao({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new q},radius:{value:4}},vertexShader:mu,fragmentShader:hu}),p=f.clone();p.defines.HORIZONTAL_PASS=1;let m=new ha;m.setAttribute(`position`,new ea(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let h=new za(m,f),g=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=1;let _=this.type;this.render=function(t,n,s){if(g.enabled===!1||g.autoUpdate===!1&&g.needsUpdate===!1||t.length===0)return;this.type===2&&(W(`WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead.`),this.type=1);let c=e.getRenderTarget(),l=e.getActiveCubeFace(),d=e.getActiveMipmapLevel(),f=e.state;f.setBlending(0),f.buffers.depth.getReversed()===!0?f.buffers.color.setClear(0,0,0,0):f.buffers.color.setClear(1,1,1,1),f.buffers.depth.setTest(!0),f.setScissorTest(!1);let p=_!==this.type;p&&n.traverse(function(e){e.material&&(Array.isArray(e.material)?e.material.forEach(e=>e.needsUpdate=!0):e.material.needsUpdate=!0)});for(let c=0,l=t.length;c<l;c++){let l=t[c],d=l.shadow;if(d===void 0){W(`WebGLShadowMap:`,l,`has no shadow.`);continue}if(d.autoUpdate===!1&&d.needsUpdate===!1)continue;i.copy(d.mapSize);let m=d.getFrameExtents();i.multiply(m),a.copy(d.mapSize),(i.x>u||i.y>u)&&(i.x>u&&(a.x=Math.floor(u/m.x),i.x=a.x*m.x,d.mapSize.x=a.x),i.y>u&&(a.y=Math.floor(u/m.y),i.y=a.y*m.y,d.mapSize.y=a.y));let h=e.state.buffers.depth.getReversed();if(d.camera._reversedDepth=h,d.map===null||p===!0){if(d.map!==null&&(d.map.depthTexture!==null&&(d.map.depthTexture.dispose(),d.map.depthTexture=null),d.map.dispose()),this.type===3){if(l.isPointLight){W(`WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.`);continue}d.map=new Ir(i.x,i.y,{format:Jt,type:Ft,minFilter:Tt,magFilter:Tt,generateMipmaps:!1}),d.map.texture.name=l.name+`.shadowMap`,d.map.depthTexture=new _o(i.x,i.y,Pt),d.map.depthTexture.name=l.name+`.shadowMapDepth`,d.map.depthTexture.format=Wt,d.map.depthTexture.compareFunction=null,d.map.depthTexture.minFilter=St,d.map.depthTexture.magFilter=St}else l.isPointLight?(d.map=new Rs(i.x),d.map.depthTexture=new vo(i.x,Nt)):(d.map=new Ir(i.x,i.y),d.map.depthTexture=new _o(i.x,i.y,Nt)),d.map.depthTexture.name=l.name+`.shadowMap`,d.map.depthTexture.format=Wt,this.type===1?(d.map.depthTexture.compareFunction=h?518:515,d.map.depthTexture.minFilter=Tt,d.map.depthTexture.magFilter=Tt):(d.map.depthTexture.compareFunction=null,d.map.depthTexture.minFilter=St,d.map.depthTexture.magFilter=St);d.camera.updateProjectionMatrix()}d.map.isWebGLCubeRenderTarget!==!0&&(d.map.width!==i.x||d.map.height!==i.y)&&d.map.setSize(i.x,i.y);let g=d.map.isWebGLCubeRenderTarget?6:d.getViewportCount();l.isPointLight!==!0&&d.updateMatrices(l,s);let _=d.camera.layers.mask&4294967294?d.camera.layers:s.layers;for(let t=0;t<g;t++){let i=d.getCamera(t);if(l.isPointLight){let e=d.camera,n=d.matrix,r=l.distance||e.far;r!==e.far&&(e.far=r,e.updateProjectionMatrix()),yu.setFromMatrixPosition(l.matrixWorld),e.position.copy(yu),bu.copy(e.position),bu.add(gu[t]),e.up.copy(_u[t]),e.lookAt(bu),e.updateMatrixWorld(),n.makeTranslation(-yu.x,-yu.y,-yu.z),vu.multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse),d._frustum.setFromProjectionMatrix(vu,e.coordinateSystem,e.reversedDepth)}if(d.map.isWebGLCubeRenderTarget)e.setRenderTarget(d.map,t),e.clear();else{t===0&&(e.setRenderTarget(d.map),e.clear());let n=d.getViewport(t);o.set(a.x*n.x,a.y*n.y,a.x*n.z,a.y*n.w),f.viewport(o)}r=d.getFrustum(t),b(n,s,i,l,_,this.type)}d.isPointLightShadow!==!0&&this.type===3&&v(d,s),d.needsUpdate=!1}_=this.type,g.needsUpdate=!1,e.setRenderTarget(c,l,d)};function v(n,r){let a=t.update(h);f.defines.VSM_SAMPLES!==n.blurSamples&&(f.defines.VSM_SAMPLES=n.blurSamples,p.defines.VSM_SAMPLES=n.blurSamples,f.needsUpdate=!0,p.needsUpdate=!0),n.mapPass===null?n.mapPass=new Ir(i.x,i.y,{format:Jt,type:Ft}):(n.mapPass.width!==n.map.width||n.mapPass.height!==n.map.height)&&n.mapPass.setSize(n.map.width,n.map.height),f.uniforms.shadow_pass.value=n.map.depthTexture,f.uniforms.resolution.value.set(n.map.width,n.map.height),f.uniforms.radius.value=n.radius,e.setRenderTarget(n.mapPass),e.clear(),e.renderBufferDirect(r,null,a,f,h,null),p.uniforms.shadow_pass.value=n.mapPass.texture,p.uniforms.resolution.value.set(n.map.width,n.map.height),p.uniforms.radius.value=n.radius,e.setRenderTarget(n.map),e.clear(),e.renderBufferDirect(r,null,a,p,h,null)}function y(t,n,r,i){let a=null,o=r.isPointLight===!0?t.customDistanceMaterial:t.customDepthMaterial;if(o!==void 0)a=o;else if(a=r.isPointLight===!0?c:s,e.localClippingEnabled&&n.clipShadows===!0&&Array.isArray(n.clippingPlanes)&&n.clippingPlanes.length!==0||n.displacementMap&&n.displacementScale!==0||n.alphaMap&&n.alphaTest>0||n.map&&n.alphaTest>0||n.alphaToCoverage===!0){let e=a.uuid,t=n.uuid,r=l[e];r===void 0&&(r={},l[e]=r);let i=r[t];i===void 0&&(i=a.clone(),r[t]=i,n.addEventListener(`dispose`,x)),a=i}if(a.visible=n.visible,a.wireframe=n.wireframe,i===3?a.side=n.shadowSide===null?n.side:n.shadowSide:a.side=n.shadowSide===null?d[n.side]:n.shadowSide,a.alphaMap=n.alphaMap,a.alphaTest=n.alphaToCoverage===!0?.5:n.alphaTest,a.map=n.map,a.clipShadows=n.clipShadows,a.clippingPlanes=n.clippingPlanes,a.clipIntersection=n.clipIntersection,a.displacementMap=n.displacementMap,a.displacementScale=n.displacementScale,a.displacementBias=n.displacementBias,a.wireframeLinewidth=n.wireframeLinewidth,a.linewidth=n.linewidth,r.isPointLight===!0&&a.isMeshDistanceMaterial===!0){let t=e.properties.get(a);t.light=r}return a}function b(n,i,a,o,s,c){if(n.visible===!1)return;if(n.layers.test(s)&&(n.isMesh||n.isLine||n.isPoints)&&(n.castShadow||n.receiveShadow&&c===3)&&(!n.frustumCulled||n.intersectsFrustum(r))){n.modelViewMatrix.multiplyMatrices(a.matrixWorldInverse,n.matrixWorld);let r=t.update(n),s=n.material;if(Array.isArray(s)){let t=r.groups;for(let l=0,u=t.length;l<u;l++){let u=t[l],d=s[u.materialIndex];if(d&&d.visible){let t=y(n,d,o,c);n.onBeforeShadow(e,n,i,a,r,t,u),e.renderBufferDirect(a,null,r,t,n,u),n.onAfterShadow(e,n,i,a,r,t,u)}}}else if(s.visible){let t=y(n,s,o,c);n.onBeforeShadow(e,n,i,a,r,t,null),e.renderBufferDirect(a,null,r,t,n,null),n.onAfterShadow(e,n,i,a,r,t,null)}}let l=n.children;for(let e=0,t=l.length;e<t;e++)b(l[e],i,a,o,s,c)}function x(e){e.target.removeEventListener(`dispose`,x);for(let t in l){let n=l[t],r=e.target.uuid;r in n&&(n[r].dispose(),delete n[r])}}}function Su(e,t){function n(){let t=!1,n=new Pr,r=null,i=new Pr(0,0,0,0);return{setMask:function(n){r!==n&&!t&&(e.colorMask(n,n,n,n),r=n)},setLocked:function(e){t=e},setClear:function(t,r,a,o,s){s===!0&&(t*=o,r*=o,a*=o),n.set(t,r,a,o),i.equals(n)===!1&&(e.clearColor(t,r,a,o),i.copy(n))},reset:function(){t=!1,r=null,i.set(-1,0,0,0)}}}function r(){let n=!1,r=!1,i=null,a=null,o=null;return{setReversed:function(e){if(r!==e){let n=t.get(`EXT_clip_control`);e?n.clipControlEXT(n.LOWER_LEFT_EXT,n.ZERO_TO_ONE_EXT):n.clipControlEXT(n.LOWER_LEFT_EXT,n.NEGATIVE_ONE_TO_ONE_EXT),r=e;let i=o;o=null,this.setClear(i)}},getReversed:function(){return r},setTest:function(t){t?oe(e.DEPTH_TEST):R(e.DEPTH_TEST)},setMask:function(t){i!==t&&!n&&(e.depthMask(t),i=t)},setFunc:function(t){if(r&&(t=ar[t]),a!==t){switch(t){case 0:e.depthFunc(e.NEVER);break;case 1:e.depthFunc(e.ALWAYS);break;case 2:e.depthFunc(e.LESS);break;case 3:e.depthFunc(e.LEQUAL);break;case 4:e.depthFunc(e.EQUAL);break;case 5:e.depthFunc(e.GEQUAL);break;case 6:e.depthFunc(e.GREATER);break;case 7:e.depthFunc(e.NOTEQUAL);break;default:e.depthFunc(e.LEQUAL)}a=t}},setLocked:function(e){n=e},setClear:function(t){o!==t&&(o=t,r&&(t=1-t),e.clearDepth(t))},reset:function(){n=!1,i=null,a=null,o=null,r=!1}}}function i(){let t=!1,n=null,r=null,i=null,a=null,o=null,s=null,c=null,l=null;return{setTest:function(n){t||(n?oe(e.STENCIL_TEST):R(e.STENCIL_TEST))},setMask:function(r){n!==r&&!t&&(e.stencilMask(r),n=r)},setFunc:function(t,n,o){(r!==t||i!==n||a!==o)&&(e.stencilFunc(t,n,o),r=t,i=n,a=o)},setOp:function(t,n,r){(o!==t||s!==n||c!==r)&&(e.stencilOp(t,n,r),o=t,s=n,c=r)},setLocked:function(e){t=e},setClear:function(t){l!==t&&(e.clearStencil(t),l=t)},reset:function(){t=!1,n=null,r=null,i=null,a=null,o=null,s=null,c=null,l=null}}}let a=new n,o=new r,s=new i,c={},l=new WeakMap,u={},d={},f={},p=new WeakMap,m=[],h=null,g=!1,_=null,v=null,y=null,b=null,x=null,S=null,C=null,w=new Z(0,0,0),T=0,E=!1,D=null,O=null,k=null,A=null,j=null,M=e.getParameter(e.MAX_COMBINED_TEXTURE_IMAGE_UNITS),N=!1,P=0,F=e.getParameter(e.VERSION);F.indexOf(`WebGL`)===-1?F.indexOf(`OpenGL ES`)!==-1&&(P=parseFloat(/^OpenGL ES (\d)/.exec(F)[1]),N=P>=2):(P=parseFloat(/^WebGL (\d)/.exec(F)[1]),N=P>=1);let I=null,ee={},te=e.getParameter(e.SCISSOR_BOX),ne=e.getParameter(e.VIEWPORT),re=new Pr().fromArray(te),ie=new Pr().fromArray(ne);function ae(t,n,r,i){let a=new Uint8Array(4),o=e.createTexture();e.bindTexture(t,o),e.texParameteri(t,e.TEXTURE_MIN_FILTER,e.NEAREST),e.texParameteri(t,e.TEXTURE_MAG_FILTER,e.NEAREST);for(let o=0;o<r;o++)t===e.TEXTURE_3D||t===e.TEXTURE_2D_ARRAY?e.texImage3D(n,0,e.RGBA,1,1,i,0,e.RGBA,e.UNSIGNED_BYTE,a):e.texImage2D(n+o,0,e.RGBA,1,1,0,e.RGBA,e.UNSIGNED_BYTE,a);return o}let L={};L[e.TEXTURE_2D]=ae(e.TEXTURE_2D,e.TEXTURE_2D,1),L[e.TEXTURE_CUBE_MAP]=ae(e.TEXTURE_CUBE_MAP,e.TEXTURE_CUBE_MAP_POSITIVE_X,6),L[e.TEXTURE_2D_ARRAY]=ae(e.TEXTURE_2D_ARRAY,e.TEXTURE_2D_ARRAY,1,1),L[e.TEXTURE_3D]=ae(e.TEXTURE_3D,e.TEXTURE_3D,1,1),a.setClear(0,0,0,1),o.setClear(1),s.setClear(0),oe(e.DEPTH_TEST),o.setFunc(3),me(!1),he(1),oe(e.CULL_FACE),fe(0);function oe(t){u[t]!==!0&&(e.enable(t),u[t]=!0)}function R(t){u[t]!==!1&&(e.disable(t),u[t]=!1)}function se(t,n){return f[t]!==n&&(e.bindFramebuffer(t,n),f[t]=n,t===e.DRAW_FRAMEBUFFER&&(f[e.FRAMEBUFFER]=n),t===e.FRAMEBUFFER&&(f[e.DRAW_FRAMEBUFFER]=n),!0)}function ce(t,n){let r=m,i=!1;if(t){r=p.get(n),r===void 0&&(r=[],p.set(n,r));let a=t.textures;if(r.length!==a.length||r[0]!==e.COLOR_ATTACHMENT0){for(let t=0,n=a.length;t<n;t++)r[t]=e.COLOR_ATTACHMENT0+t;r.length=a.length,i=!0}}else r[0]!==e.BACK&&(r[0]=e.BACK,i=!0);i&&e.drawBuffers(r)}function le(t){return h!==t&&(e.useProgram(t),h=t,!0)}let ue={100:e.FUNC_ADD,101:e.FUNC_SUBTRACT,102:e.FUNC_REVERSE_SUBTRACT};ue[103]=e.MIN,ue[104]=e.MAX;let de={200:e.ZERO,201:e.ONE,202:e.SRC_COLOR,204:e.SRC_ALPHA,210:e.SRC_ALPHA_SATURATE,208:e.DST_COLOR,206:e.DST_ALPHA,203:e.ONE_MINUS_SRC_COLOR,205:e.ONE_MINUS_SRC_ALPHA,209:e.ONE_MINUS_DST_COLOR,207:e.ONE_MINUS_DST_ALPHA,211:e.CONSTANT_COLOR,212:e.ONE_MINUS_CONSTANT_COLOR,213:e.CONSTANT_ALPHA,214:e.ONE_MINUS_CONSTANT_ALPHA};function fe(t,n,r,i,a,o,s,c,l,u){if(t===0)g===!0&&(R(e.BLEND),g=!1);else if(g===!1&&(oe(e.BLEND),g=!0),t!==5){if(t!==_||u!==E){if((v!==100||x!==100)&&(e.blendEquation(e.FUNC_ADD),v=100,x=100),u)switch(t){case 1:e.blendFuncSeparate(e.ONE,e.ONE_MINUS_SRC_ALPHA,e.ONE,e.ONE_MINUS_SRC_ALPHA);break;case 2:e.blendFunc(e.ONE,e.ONE);break;case 3:e.blendFuncSeparate(e.ZERO,e.ONE_MINUS_SRC_COLOR,e.ZERO,e.ONE);break;case 4:e.blendFuncSeparate(e.DST_COLOR,e.ONE_MINUS_SRC_ALPHA,e.ZERO,e.ONE);break;default:G(`WebGLState: Invalid blending: `,t)}else switch(t){case 1:e.blendFuncSeparate(e.SRC_ALPHA,e.ONE_MINUS_SRC_ALPHA,e.ONE,e.ONE_MINUS_SRC_ALPHA);break;case 2:e.blendFuncSeparate(e.SRC_ALPHA,e.ONE,e.ONE,e.ONE);break;case 3:G(`WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true`);break;case 4:G(`WebGLState: MultiplyBlending requires material.premultipliedAlpha = true`);break;default:G(`WebGLState: Invalid blending: `,t)}y=null,b=null,S=null,C=null,w.set(0,0,0),T=0,_=t,E=u}}else a||=n,o||=r,s||=i,(n!==v||a!==x)&&(e.blendEquationSeparate(ue[n],ue[a]),v=n,x=a),(r!==y||i!==b||o!==S||s!==C)&&(e.blendFuncSeparate(de[r],de[i],de[o],de[s]),y=r,b=i,S=o,C=s),(c.equals(w)===!1||l!==T)&&(e.blendColor(c.r,c.g,c.b,l),w.copy(c),T=l),_=t,E=!1}function pe(t,n){t.side===2?R(e.CULL_FACE):oe(e.CULL_FACE);let r=t.side===1;n&&(r=!r),me(r),t.blending===1&&t.transparent===!1?fe(0):fe(t.blending,t.blendEquation,t.blendSrc,t.blendDst,t.blendEquationAlpha,t.blendSrcAlpha,t.blendDstAlpha,t.blendColor,t.blendAlpha,t.premultipliedAlpha),o.setFunc(t.depthFunc),o.setTest(t.depthTest),o.setMask(t.depthWrite),a.setMask(t.colorWrite);let i=t.stencilWrite;s.setTest(i),i&&(s.setMask(t.stencilWriteMask),s.setFunc(t.stencilFunc,t.stencilRef,t.stencilFuncMask),s.setOp(t.stencilFail,t.stencilZFail,t.stencilZPass)),_e(t.polygonOffset,t.polygonOffsetFactor,t.polygonOffsetUnits),t.alphaToCoverage===!0?oe(e.SAMPLE_ALPHA_TO_COVERAGE):R(e.SAMPLE_ALPHA_TO_COVERAGE)}function me(t){D!==t&&(t?e.frontFace(e.CW):e.frontFace(e.CCW),D=t)}function he(t){t===0?R(e.CULL_FACE):(oe(e.CULL_FACE),t!==O&&(t===1?e.cullFace(e.BACK):t===2?e.cullFace(e.FRONT):e.cullFace(e.FRONT_AND_BACK))),O=t}function ge(t){t!==k&&(N&&e.lineWidth(t),k=t)}function _e(t,n,r){t?(oe(e.POLYGON_OFFSET_FILL),(A!==n||j!==r)&&(A=n,j=r,o.getReversed()&&(n=-n,r=-r),e.polygonOffset(n,r))):R(e.POLYGON_OFFSET_FILL)}function ve(t){t?oe(e.SCISSOR_TEST):R(e.SCISSOR_TEST)}function ye(t){t===void 0&&(t=e.TEXTURE0+M-1),I!==t&&(e.activeTexture(t),I=t)}function z(t,n,r){r===void 0&&(r=I===null?e.TEXTURE0+M-1:I);let i=ee[r];i===void 0&&(i={type:void 0,texture:void 0},ee[r]=i),(i.type!==t||i.texture!==n)&&(I!==r&&(e.activeTexture(r),I=r),e.bindTexture(t,n||L[t]),i.type=t,i.texture=n)}function be(){let t=ee[I];t!==void 0&&t.type!==void 0&&(e.bindTexture(t.type,null),t.type=void 0,t.texture=void 0)}function xe(){try{e.compressedTexImage2D(...arguments)}catch(e){G(`WebGLState:`,e)}}function Se(){try{e.compressedTexImage3D(...arguments)}catch(e){G(`WebGLState:`,e)}}function B(){try{e.texSubImage2D(...arguments)}catch(e){G(`WebGLState:`,e)}}function Ce(){try{e.texSubImage3D(...arguments)}catch(e){G(`WebGLState:`,e)}}function V(){try{e.compressedTexSubImage2D(...arguments)}catch(e){G(`WebGLState:`,e)}}function H(){try{e.compressedTexSubImage3D(...arguments)}catch(e){G(`WebGLState:`,e)}}function we(){try{e.texStorage2D(...arguments)}catch(e){G(`WebGLState:`,e)}}function Te(){try{e.texStorage3D(...arguments)}catch(e){G(`WebGLState:`,e)}}function Ee(){try{e.texImage2D(...arguments)}catch(e){G(`WebGLState:`,e)}}function De(){try{e.texImage3D(...arguments)}catch(e){G(`WebGLState:`,e)}}function U(t){return d[t]===void 0?e.getParameter(t):d[t]}function Oe(t,n){d[t]!==n&&(e.pixelStorei(t,n),d[t]=n)}function ke(t){re.equals(t)===!1&&(e.scissor(t.x,t.y,t.z,t.w),re.copy(t))}function Ae(t){ie.equals(t)===!1&&(e.viewport(t.x,t.y,t.z,t.w),ie.copy(t))}function je(t,n){let r=l.get(n);r===void 0&&(r=new WeakMap,l.set(n,r));let i=r.get(t);i===void 0&&(i=e.getUniformBlockIndex(n,t.name),e.uniformBlockBinding(n,i,i),r.set(t,i))}function Me(t,n,r){let i=l.get(n).get(t);c[i]!==r&&(e.bindBufferBase(e.UNIFORM_BUFFER,i,r),c[i]=r)}function Ne(){e.disable(e.BLEND),e.disable(e.CULL_FACE),e.disable(e.DEPTH_TEST),e.disable(e.POLYGON_OFFSET_FILL),e.disable(e.SCISSOR_TEST),e.disable(e.STENCIL_TEST),e.disable(e.SAMPLE_ALPHA_TO_COVERAGE),e.blendEquation(e.FUNC_ADD),e.blendFunc(e.ONE,e.ZERO),e.blendFuncSeparate(e.ONE,e.ZERO,e.ONE,e.ZERO),e.blendColor(0,0,0,0),e.colorMask(!0,!0,!0,!0),e.clearColor(0,0,0,0),e.depthMask(!0),e.depthFunc(e.LESS),o.setReversed(!1),e.clearDepth(1),e.stencilMask(4294967295),e.stencilFunc(e.ALWAYS,0,4294967295),e.stencilOp(e.KEEP,e.KEEP,e.KEEP),e.clearStencil(0),e.cullFace(e.BACK),e.frontFace(e.CCW),e.polygonOffset(0,0),e.activeTexture(e.TEXTURE0),e.bindFramebuffer(e.FRAMEBUFFER,null),e.bindFramebuffer(e.DRAW_FRAMEBUFFER,null),e.bindFramebuffer(e.READ_FRAMEBUFFER,null),e.useProgram(null),e.lineWidth(1),e.scissor(0,0,e.canvas.width,e.canvas.height),e.viewport(0,0,e.canvas.width,e.canvas.height),e.pixelStorei(e.PACK_ALIGNMENT,4),e.pixelStorei(e.UNPACK_ALIGNMENT,4),e.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,!1),e.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),e.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,e.BROWSER_DEFAULT_WEBGL),e.pixelStorei(e.PACK_ROW_LENGTH,0),e.pixelStorei(e.PACK_SKIP_PIXELS,0),e.pixelStorei(e.PACK_SKIP_ROWS,0),e.pixelStorei(e.UNPACK_ROW_LENGTH,0),e.pixelStorei(e.UNPACK_IMAGE_HEIGHT,0),e.pixelStorei(e.UNPACK_SKIP_PIXELS,0),e.pixelStorei(e.UNPACK_SKIP_ROWS,0),e.pixelStorei(e.UNPACK_SKIP_IMAGES,0),u={},d={},I=null,ee={},f={},c={},p=new WeakMap,m=[],h=null,g=!1,_=null,v=null,y=null,b=null,x=null,S=null,C=null,w=new Z(0,0,0),T=0,E=!1,D=null,O=null,k=null,A=null,j=null,re.set(0,0,e.canvas.width,e.canvas.height),ie.set(0,0,e.canvas.width,e.canvas.height),a.reset(),o.reset(),s.reset()}return{buffers:{color:a,depth:o,stencil:s},enable:oe,disable:R,bindFramebuffer:se,drawBuffers:ce,useProgram:le,setBlending:fe,setMaterial:pe,setFlipSided:me,setCullFace:he,setLineWidth:ge,setPolygonOffset:_e,setScissorTest:ve,activeTexture:ye,bindTexture:z,unbindTexture:be,compressedTexImage2D:xe,compressedTexImage3D:Se,texImage2D:Ee,texImage3D:De,pixelStorei:Oe,getParameter:U,updateUBOMapping:je,uniformBlockBinding:Me,texStorage2D:we,texStorage3D:Te,texSubImage2D:B,texSubImage3D:Ce,compressedTexSubImage2D:V,compressedTexSubImage3D:H,scissor:ke,viewport:Ae,reset:Ne}}function Cu(e,t,n,r,i,a,o){let s=t.has(`WEBGL_multisampled_render_to_texture`)?t.get(`WEBGL_multisampled_render_to_texture`):null,c=typeof navigator>`u`?!1:/OculusBrowser/g.test(navigator.userAgent),l=new q,u=new WeakMap,d=new Set,f,p=new WeakMap,m=new Set,h=new FinalizationRegistry(e=>m.delete(e)),g=!1;try{g=typeof OffscreenCanvas<`u`&&new OffscreenCanvas(1,1).getContext(`2d`)!==null}catch{}function _(e,t){return g?new OffscreenCanvas(e,t):Qn(`canvas`)}function v(e,t,n){let r=1,i=we(e);if((i.width>n||i.height>n)&&(r=n/Math.max(i.width,i.height)),r<1){if(typeof HTMLImageElement<`u`&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<`u`&&e instanceof HTMLCanvasElement||typeof ImageBitmap<`u`&&e instanceof ImageBitmap||typeof VideoFrame<`u`&&e instanceof VideoFrame){let n=Math.floor(r*i.width),a=Math.floor(r*i.height);f===void 0&&(f=_(n,a));let o=t?_(n,a):f;return o.width=n,o.height=a,o.getContext(`2d`).drawImage(e,0,0,n,a),W(`WebGLRenderer: Texture has been resized from (`+i.width+`x`+i.height+`) to (`+n+`x`+a+`).`),o}return`data`in e&&W(`WebGLRenderer: Image in DataTexture is too big (`+i.width+`x`+i.height+`).`),e}return e}function y(e){return e.generateMipmaps}function b(t){e.generateMipmap(t)}function x(t){return t.isWebGLCubeRenderTarget?e.TEXTURE_CUBE_MAP:t.isWebGL3DRenderTarget?e.TEXTURE_3D:t.isWebGLArrayRenderTarget||t.isCompressedArrayTexture?e.TEXTURE_2D_ARRAY:e.TEXTURE_2D}function S(n,r,i,a,o,s=!1){if(n!==null){if(e[n]!==void 0)return e[n];W(`WebGLRenderer: Attempt to use non-existing WebGL internal format '`+n+`'`)}let c;a&&(c=t.get(`EXT_texture_norm16`),c||W(`WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension`));let l=r;if(r===e.RED&&(i===e.FLOAT&&(l=e.R32F),i===e.HALF_FLOAT&&(l=e.R16F),i===e.UNSIGNED_BYTE&&(l=e.R8),i===e.UNSIGNED_SHORT&&c&&(l=c.R16_EXT),i===e.SHORT&&c&&(l=c.R16_SNORM_EXT)),r===e.RED_INTEGER&&(i===e.UNSIGNED_BYTE&&(l=e.R8UI),i===e.UNSIGNED_SHORT&&(l=e.R16UI),i===e.UNSIGNED_INT&&(l=e.R32UI),i===e.BYTE&&(l=e.R8I),i===e.SHORT&&(l=e.R16I),i===e.INT&&(l=e.R32I)),r===e.RG&&(i===e.FLOAT&&(l=e.RG32F),i===e.HALF_FLOAT&&(l=e.RG16F),i===e.UNSIGNED_BYTE&&(l=e.RG8),i===e.UNSIGNED_SHORT&&c&&(l=c.RG16_EXT),i===e.SHORT&&c&&(l=c.RG16_SNORM_EXT)),r===e.RG_INTEGER&&(i===e.UNSIGNED_BYTE&&(l=e.RG8UI),i===e.UNSIGNED_SHORT&&(l=e.RG16UI),i===e.UNSIGNED_INT&&(l=e.RG32UI),i===e.BYTE&&(l=e.RG8I),i===e.SHORT&&(l=e.RG16I),i===e.INT&&(l=e.RG32I)),r===e.RGB_INTEGER&&(i===e.UNSIGNED_BYTE&&(l=e.RGB8UI),i===e.UNSIGNED_SHORT&&(l=e.RGB16UI),i===e.UNSIGNED_INT&&(l=e.RGB32UI),i===e.BYTE&&(l=e.RGB8I),i===e.SHORT&&(l=e.RGB16I),i===e.INT&&(l=e.RGB32I)),r===e.RGBA_INTEGER&&(i===e.UNSIGNED_BYTE&&(l=e.RGBA8UI),i===e.UNSIGNED_SHORT&&(l=e.RGBA16UI),i===e.UNSIGNED_INT&&(l=e.RGBA32UI),i===e.BYTE&&(l=e.RGBA8I),i===e.SHORT&&(l=e.RGBA16I),i===e.INT&&(l=e.RGBA32I)),r===e.RGB&&(i===e.UNSIGNED_SHORT&&c&&(l=c.RGB16_EXT),i===e.SHORT&&c&&(l=c.RGB16_SNORM_EXT),i===e.UNSIGNED_INT_5_9_9_9_REV&&(l=e.RGB9_E5),i===e.UNSIGNED_INT_10F_11F_11F_REV&&(l=e.R11F_G11F_B10F)),r===e.RGBA){let t=s?Wn:X.getTransfer(o);i===e.FLOAT&&(l=e.RGBA32F),i===e.HALF_FLOAT&&(l=e.RGBA16F),i===e.UNSIGNED_BYTE&&(l=t===`srgb`?e.SRGB8_ALPHA8:e.RGBA8),i===e.UNSIGNED_SHORT&&c&&(l=c.RGBA16_EXT),i===e.SHORT&&c&&(l=c.RGBA16_SNORM_EXT),i===e.UNSIGNED_SHORT_4_4_4_4&&(l=e.RGBA4),i===e.UNSIGNED_SHORT_5_5_5_1&&(l=e.RGB5_A1)}return(l===e.R16F||l===e.R32F||l===e.RG16F||l===e.RG32F||l===e.RGBA16F||l===e.RGBA32F)&&t.get(`EXT_color_buffer_float`),l}function C(t,n){let r;return t?n===null||n===1014||n===1020?r=e.DEPTH24_STENCIL8:n===1015?r=e.DEPTH32F_STENCIL8:n===1012&&(r=e.DEPTH24_STENCIL8,W(`DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.`)):n===null||n===1014||n===1020?r=e.DEPTH_COMPONENT24:n===1015?r=e.DEPTH_COMPONENT32F:n===1012&&(r=e.DEPTH_COMPONENT16),r}function w(e,t){return y(e)===!0||e.isFramebufferTexture&&e.minFilter!==1003&&e.minFilter!==1006?Math.log2(Math.max(t.width,t.height))+1:e.mipmaps.length>0?e.mipmaps.length:e.isCompressedTexture&&Array.isArray(e.image)?t.mipmaps.length:1}function T(e){let t=new WeakRef(e);r.get(e).__ref=t,m.add(t),h.register(e,t,t)}function E(e){let t=r.get(e).__ref;t!==void 0&&(m.delete(t),h.unregister(t))}function D(e){k(e.target)}function O(e){A(e.target)}function k(e){e.removeEventListener(`dispose`,D),E(e),M(e),e.isVideoTexture&&u.delete(e),e.isHTMLTexture&&d.delete(e)}function A(e){e.removeEventListener(`dispose`,O),E(e),P(e)}function j(){for(let e of m){let t=e.deref();t!==void 0&&(t.isRenderTarget===!0?A(t):k(t))}m.clear(),d.clear()}function M(e){let t=r.get(e);if(t.__webglInit===void 0)return;let n=e.source,i=p.get(n);if(i){let r=i[t.__cacheKey];r.usedTimes--,r.usedTimes===0&&N(e),Object.keys(i).length===0&&p.delete(n)}r.remove(e)}function N(t){let n=r.get(t);e.deleteTexture(n.__webglTexture);let i=t.source,a=p.get(i);delete a[n.__cacheKey],o.memory.textures--}function P(t){let n=r.get(t);n.__depthDisposeCallback&&n.__depthDisposeCallback();let i=t.depthTexture;if(i&&i.renderTarget===t&&k(i),t.isWebGLCubeRenderTarget)for(let t=0;t<6;t++){if(Array.isArray(n.__webglFramebuffer[t]))for(let r=0;r<n.__webglFramebuffer[t].length;r++)e.deleteFramebuffer(n.__webglFramebuffer[t][r]);else e.deleteFramebuffer(n.__webglFramebuffer[t]);n.__webglDepthbuffer&&e.deleteRenderbuffer(n.__webglDepthbuffer[t])}else{if(Array.isArray(n.__webglFramebuffer))for(let t=0;t<n.__webglFramebuffer.length;t++)e.deleteFramebuffer(n.__webglFramebuffer[t]);else e.deleteFramebuffer(n.__webglFramebuffer);if(n.__webglDepthbuffer&&e.deleteRenderbuffer(n.__webglDepthbuffer),n.__webglMultisampledFramebuffer&&e.deleteFramebuffer(n.__webglMultisampledFramebuffer),n.__webglColorRenderbuffer)for(let t=0;t<n.__webglColorRenderbuffer.length;t++)n.__webglColorRenderbuffer[t]&&e.deleteRenderbuffer(n.__webglColorRenderbuffer[t]);n.__webglDepthRenderbuffer&&e.deleteRenderbuffer(n.__webglDepthRenderbuffer)}let a=t.textures;for(let t=0,n=a.length;t<n;t++){let n=r.get(a[t]);n.__webglTexture&&(e.deleteTexture(n.__webglTexture),o.memory.textures--),r.remove(a[t])}r.remove(t)}let F=0;function I(){F=0}function ee(){return F}function te(e){F=e}function ne(){let e=F;return e>=i.maxTextures&&W(`WebGLTextures: Trying to use `+(e+1)+` texture units while this GPU supports only `+i.maxTextures),F+=1,e}function re(e){let t=[];return t.push(e.wrapS),t.push(e.wrapT),t.push(e.wrapR||0),t.push(e.magFilter),t.push(e.minFilter),t.push(e.anisotropy),t.push(e.internalFormat),t.push(e.format),t.push(e.type),t.push(e.generateMipmaps),t.push(e.mipmapsAutoUpdate),t.push(e.premultiplyAlpha),t.push(e.flipY),t.push(e.unpackAlignment),t.push(e.colorSpace),t.join()}function ie(t,i){let a=r.get(t);if(t.isVideoTexture&&V(t),t.isRenderTargetTexture===!1&&t.isExternalTexture!==!0&&t.version>0&&a.__version!==t.version){let e=t.image;if(e===null)W(`WebGLRenderer: Texture marked for update but no image data found.`);else if(e.complete===!1)W(`WebGLRenderer: Texture marked for update but image is incomplete`);else{pe(a,t,i);return}}else t.isExternalTexture&&(a.__webglTexture=t.sourceTexture?t.sourceTexture:null);n.bindTexture(e.TEXTURE_2D,a.__webglTexture,e.TEXTURE0+i)}function ae(t,i){let a=r.get(t);t.isRenderTargetTexture===!1&&t.version>0&&a.__version!==t.version?pe(a,t,i):(t.isExternalTexture&&(a.__webglTexture=t.sourceTexture?t.sourceTexture:null),n.bindTexture(e.TEXTURE_2D_ARRAY,a.__webglTexture,e.TEXTURE0+i))}function L(t,i){let a=r.get(t);t.isRenderTargetTexture===!1&&t.version>0&&a.__version!==t.version?pe(a,t,i):n.bindTexture(e.TEXTURE_3D,a.__webglTexture,e.TEXTURE0+i)}function oe(t,i){let a=r.get(t);t.version>0&&a.__version!==t.version?me(a,t,i):n.bindTexture(e.TEXTURE_CUBE_MAP,a.__webglTexture,e.TEXTURE0+i)}let R={[yt]:e.REPEAT,[bt]:e.CLAMP_TO_EDGE,[xt]:e.MIRRORED_REPEAT},se={[St]:e.NEAREST,[Ct]:e.NEAREST_MIPMAP_NEAREST,[wt]:e.NEAREST_MIPMAP_LINEAR,[Tt]:e.LINEAR,[Et]:e.LINEAR_MIPMAP_NEAREST,[Dt]:e.LINEAR_MIPMAP_LINEAR},ce={512:e.NEVER,519:e.ALWAYS,513:e.LESS,515:e.LEQUAL,514:e.EQUAL,518:e.GEQUAL,516:e.GREATER,517:e.NOTEQUAL};function le(n,a){if(a.type===1015&&t.has(`OES_texture_float_linear`)===!1&&(a.magFilter===1006||a.magFilter===1007||a.magFilter===1005||a.magFilter===1008||a.minFilter===1006||a.minFilter===1007||a.minFilter===1005||a.minFilter===1008)&&W(`WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device.`),e.texParameteri(n,e.TEXTURE_WRAP_S,R[a.wrapS]),e.texParameteri(n,e.TEXTURE_WRAP_T,R[a.wrapT]),(n===e.TEXTURE_3D||n===e.TEXTURE_2D_ARRAY)&&e.texParameteri(n,e.TEXTURE_WRAP_R,R[a.wrapR]),e.texParameteri(n,e.TEXTURE_MAG_FILTER,se[a.magFilter]),e.texParameteri(n,e.TEXTURE_MIN_FILTER,se[a.minFilter]),a.compareFunction&&(e.texParameteri(n,e.TEXTURE_COMPARE_MODE,e.COMPARE_REF_TO_TEXTURE),e.texParameteri(n,e.TEXTURE_COMPARE_FUNC,ce[a.compareFunction])),t.has(`EXT_texture_filter_anisotropic`)===!0){if(a.magFilter===1003||a.minFilter!==1005&&a.minFilter!==1008||a.type===1015&&t.has(`OES_texture_float_linear`)===!1)return;if(a.anisotropy>1||r.get(a).__currentAnisotropy){let o=t.get(`EXT_texture_filter_anisotropic`);e.texParameterf(n,o.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(a.anisotropy,i.getMaxAnisotropy())),r.get(a).__currentAnisotropy=a.anisotropy}}}function ue(t,n){let r=!1;t.__webglInit===void 0&&(t.__webglInit=!0,n.addEventListener(`dispose`,D),T(n));let i=n.source,a=p.get(i);a===void 0&&(a={},p.set(i,a));let s=re(n);if(s!==t.__cacheKey){a[s]===void 0&&(a[s]={texture:e.createTexture(),usedTimes:0},o.memory.textures++,r=!0),a[s].usedTimes++;let i=a[t.__cacheKey];i!==void 0&&(a[t.__cacheKey].usedTimes--,i.usedTimes===0&&N(n)),t.__cacheKey=s,t.__webglTexture=a[s].texture}return r}function de(e,t,n){return Math.floor(Math.floor(e/n)/t)}function fe(t,r,i,a){let o=t.updateRanges;if(o.length===0)n.texSubImage2D(e.TEXTURE_2D,0,0,0,r.width,r.height,i,a,r.data);else{o.sort((e,t)=>e.start-t.start);let s=0;for(let e=1;e<o.length;e++){let t=o[s],n=o[e],i=t.start+t.count,a=de(n.start,r.width,4),c=de(t.start,r.width,4);n.start<=i+1&&a===c&&de(n.start+n.count-1,r.width,4)===a?t.count=Math.max(t.count,n.start+n.count-t.start):(++s,o[s]=n)}o.length=s+1;let c=n.getParameter(e.UNPACK_ROW_LENGTH),l=n.getParameter(e.UNPACK_SKIP_PIXELS),u=n.getParameter(e.UNPACK_SKIP_ROWS);n.pixelStorei(e.UNPACK_ROW_LENGTH,r.width);for(let t=0,s=o.length;t<s;t++){let s=o[t],c=Math.floor(s.start/4),l=Math.ceil(s.count/4),u=c%r.width,d=Math.floor(c/r.width),f=l;n.pixelStorei(e.UNPACK_SKIP_PIXELS,u),n.pixelStorei(e.UNPACK_SKIP_ROWS,d),n.texSubImage2D(e.TEXTURE_2D,0,u,d,f,1,i,a,r.data)}t.clearUpdateRanges(),n.pixelStorei(e.UNPACK_ROW_LENGTH,c),n.pixelStorei(e.UNPACK_SKIP_PIXELS,l),n.pixelStorei(e.UNPACK_SKIP_ROWS,u)}}function pe(t,o,s){let c=e.TEXTURE_2D;(o.isDataArrayTexture||o.isCompressedArrayTexture)&&(c=e.TEXTURE_2D_ARRAY),o.isData3DTexture&&(c=e.TEXTURE_3D);let l=ue(t,o),u=o.source;n.bindTexture(c,t.__webglTexture,e.TEXTURE0+s);let f=r.get(u);if(u.version!==f.__version||l===!0){if(n.activeTexture(e.TEXTURE0+s),!(typeof ImageBitmap<`u`&&o.image instanceof ImageBitmap)){let t=X.getPrimaries(X.workingColorSpace),r=o.colorSpace===``?null:X.getPrimaries(o.colorSpace),i=o.colorSpace===``||t===r?e.NONE:e.BROWSER_DEFAULT_WEBGL;n.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,o.flipY),n.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,o.premultiplyAlpha),n.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,i)}n.pixelStorei(e.UNPACK_ALIGNMENT,o.unpackAlignment);let t=v(o.image,!1,i.maxTextureSize);t=H(o,t);let r=a.convert(o.format,o.colorSpace),p=a.convert(o.type),m=S(o.internalFormat,r,p,o.normalized,o.colorSpace,o.isVideoTexture);le(c,o);let h,g=o.mipmaps,_=o.isVideoTexture!==!0,x=f.__version===void 0||l===!0,T=u.dataReady,E=w(o,t);if(o.isDepthTexture)m=C(o.format===Gt,o.type),x&&(_?n.texStorage2D(e.TEXTURE_2D,1,m,t.width,t.height):n.texImage2D(e.TEXTURE_2D,0,m,t.width,t.height,0,r,p,null));else if(o.isDataTexture){if(g.length>0){_&&x&&n.texStorage2D(e.TEXTURE_2D,E,m,g[0].width,g[0].height);for(let t=0,i=g.length;t<i;t++)h=g[t],_?T&&n.texSubImage2D(e.TEXTURE_2D,t,0,0,h.width,h.height,r,p,h.data):n.texImage2D(e.TEXTURE_2D,t,m,h.width,h.height,0,r,p,h.data);o.generateMipmaps=!1}else _?(x&&n.texStorage2D(e.TEXTURE_2D,E,m,t.width,t.height),T&&fe(o,t,r,p)):n.texImage2D(e.TEXTURE_2D,0,m,t.width,t.height,0,r,p,t.data)}else if(o.isCompressedTexture){if(o.isCompressedArrayTexture){_&&x&&n.texStorage3D(e.TEXTURE_2D_ARRAY,E,m,g[0].width,g[0].height,t.depth);for(let i=0,a=g.length;i<a;i++)if(h=g[i],o.format!==1023){if(r!==null){if(_){if(T){if(o.layerUpdates.size>0){let t=Ts(h.width,h.height,o.format,o.type);for(let a of o.layerUpdates){let o=h.data.subarray(a*t/h.data.BYTES_PER_ELEMENT,(a+1)*t/h.data.BYTES_PER_ELEMENT);n.compressedTexSubImage3D(e.TEXTURE_2D_ARRAY,i,0,0,a,h.width,h.height,1,r,o)}}else n.compressedTexSubImage3D(e.TEXTURE_2D_ARRAY,i,0,0,0,h.width,h.height,t.depth,r,h.data)}}else n.compressedTexImage3D(e.TEXTURE_2D_ARRAY,i,m,h.width,h.height,t.depth,0,h.data,0,0)}else W(`WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()`)}else _?T&&n.texSubImage3D(e.TEXTURE_2D_ARRAY,i,0,0,0,h.width,h.height,t.depth,r,p,h.data):n.texImage3D(e.TEXTURE_2D_ARRAY,i,m,h.width,h.height,t.depth,0,r,p,h.data);o.layerUpdates.size>0&&o.clearLayerUpdates()}else{_&&x&&n.texStorage2D(e.TEXTURE_2D,E,m,g[0].width,g[0].height);for(let t=0,i=g.length;t<i;t++)h=g[t],o.format===1023?_?T&&n.texSubImage2D(e.TEXTURE_2D,t,0,0,h.width,h.height,r,p,h.data):n.texImage2D(e.TEXTURE_2D,t,m,h.width,h.height,0,r,p,h.data):r===null?W(`WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()`):_?T&&n.compressedTexSubImage2D(e.TEXTURE_2D,t,0,0,h.width,h.height,r,h.data):n.compressedTexImage2D(e.TEXTURE_2D,t,m,h.width,h.height,0,h.data)}}else if(o.isDataArrayTexture){if(_){if(x&&n.texStorage3D(e.TEXTURE_2D_ARRAY,E,m,t.width,t.height,t.depth),T){if(o.layerUpdates.size>0){let i=Ts(t.width,t.height,o.format,o.type);for(let a of o.layerUpdates){let o=t.data.subarray(a*i/t.data.BYTES_PER_ELEMENT,(a+1)*i/t.data.BYTES_PER_ELEMENT);n.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,a,t.width,t.height,1,r,p,o)}o.clearLayerUpdates()}else n.texSubImage3D(e.TEXTURE_2D_ARRAY,0,0,0,0,t.width,t.height,t.depth,r,p,t.data)}}else n.texImage3D(e.TEXTURE_2D_ARRAY,0,m,t.width,t.height,t.depth,0,r,p,t.data)}else if(o.isData3DTexture)_?(x&&n.texStorage3D(e.TEXTURE_3D,E,m,t.width,t.height,t.depth),T&&n.texSubImage3D(e.TEXTURE_3D,0,0,0,0,t.width,t.height,t.depth,r,p,t.data)):n.texImage3D(e.TEXTURE_3D,0,m,t.width,t.height,t.depth,0,r,p,t.data);else if(o.isFramebufferTexture){if(x){if(_)n.texStorage2D(e.TEXTURE_2D,E,m,t.width,t.height);else{let i=t.width,a=t.height;for(let t=0;t<E;t++)n.texImage2D(e.TEXTURE_2D,t,m,i,a,0,r,p,null),i>>=1,a>>=1}}}else if(o.isHTMLTexture){if(`texElementImage2D`in e){let n=e.canvas;if(n.hasAttribute(`layoutsubtree`)||n.setAttribute(`layoutsubtree`,`true`),t.parentNode!==n){n.appendChild(t),d.add(o),n.onpaint=e=>{let t=e.changedElements;for(let e of d)t.includes(e.image)&&(e.needsUpdate=!0)},n.requestPaint();return}if(e.texElementImage2D.length===3)e.texElementImage2D(e.TEXTURE_2D,e.RGBA8,t);else{let n=e.RGBA,r=e.RGBA,i=e.UNSIGNED_BYTE;e.texElementImage2D(e.TEXTURE_2D,0,n,r,i,t)}e.texParameteri(e.TEXTURE_2D,e.TEXTURE_MIN_FILTER,e.LINEAR),e.texParameteri(e.TEXTURE_2D,e.TEXTURE_WRAP_S,e.CLAMP_TO_EDGE),e.texParameteri(e.TEXTURE_2D,e.TEXTURE_WRAP_T,e.CLAMP_TO_EDGE)}}else if(g.length>0){if(_&&x){let t=we(g[0]);n.texStorage2D(e.TEXTURE_2D,E,m,t.width,t.height)}for(let t=0,i=g.length;t<i;t++)h=g[t],_?T&&n.texSubImage2D(e.TEXTURE_2D,t,0,0,r,p,h):n.texImage2D(e.TEXTURE_2D,t,m,r,p,h);o.generateMipmaps=!1}else if(_){if(x){let r=we(t);n.texStorage2D(e.TEXTURE_2D,E,m,r.width,r.height)}T&&n.texSubImage2D(e.TEXTURE_2D,0,0,0,r,p,t)}else n.texImage2D(e.TEXTURE_2D,0,m,r,p,t);y(o)&&o.mipmapsAutoUpdate===!0&&b(c),f.__version=u.version,o.onUpdate&&o.onUpdate(o)}t.__version=o.version}function me(t,o,s){if(o.image.length!==6)return;let c=ue(t,o),l=o.source;n.bindTexture(e.TEXTURE_CUBE_MAP,t.__webglTexture,e.TEXTURE0+s);let u=r.get(l);if(l.version!==u.__version||c===!0){n.activeTexture(e.TEXTURE0+s);let t=X.getPrimaries(X.workingColorSpace),r=o.colorSpace===``?null:X.getPrimaries(o.colorSpace),d=o.colorSpace===``||t===r?e.NONE:e.BROWSER_DEFAULT_WEBGL;n.pixelStorei(e.UNPACK_FLIP_Y_WEBGL,o.flipY),n.pixelStorei(e.UNPACK_PREMULTIPLY_ALPHA_WEBGL,o.premultiplyAlpha),n.pixelStorei(e.UNPACK_ALIGNMENT,o.unpackAlignment),n.pixelStorei(e.UNPACK_COLORSPACE_CONVERSION_WEBGL,d);let f=o.isCompressedTexture||o.image[0].isCompressedTexture,p=o.image[0]&&o.image[0].isDataTexture,m=[];for(let e=0;e<6;e++)!f&&!p?m[e]=v(o.image[e],!0,i.maxCubemapSize):m[e]=p?o.image[e].image:o.image[e],m[e]=H(o,m[e]);let h=m[0],g=a.convert(o.format,o.colorSpace),_=a.convert(o.type),x=S(o.internalFormat,g,_,o.normalized,o.colorSpace),T=o.isVideoTexture!==!0,E=u.__version===void 0||c===!0,D=l.dataReady,O=w(o,h);le(e.TEXTURE_CUBE_MAP,o);let k;if(o.isDepthTexture){if(x=C(o.format===Gt,o.type),E){if(T)n.texStorage2D(e.TEXTURE_CUBE_MAP,1,x,h.width,h.height);else for(let t=0;t<6;t++)n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,0,x,h.width,h.height,0,g,_,null)}}else if(f){T&&E&&n.texStorage2D(e.TEXTURE_CUBE_MAP,O,x,h.width,h.height);for(let t=0;t<6;t++){k=m[t].mipmaps;for(let r=0;r<k.length;r++){let i=k[r];o.format===1023?T?D&&n.texSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r,0,0,i.width,i.height,g,_,i.data):n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r,x,i.width,i.height,0,g,_,i.data):g===null?W(`WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()`):T?D&&n.compressedTexSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r,0,0,i.width,i.height,g,i.data):n.compressedTexImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r,x,i.width,i.height,0,i.data)}}}else{if(k=o.mipmaps,T&&E){k.length>0&&O++;let t=we(m[0]);n.texStorage2D(e.TEXTURE_CUBE_MAP,O,x,t.width,t.height)}for(let t=0;t<6;t++)if(p){T?D&&n.texSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,0,0,0,m[t].width,m[t].height,g,_,m[t].data):n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,0,x,m[t].width,m[t].height,0,g,_,m[t].data);for(let r=0;r<k.length;r++){let i=k[r].image[t].image;T?D&&n.texSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r+1,0,0,i.width,i.height,g,_,i.data):n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r+1,x,i.width,i.height,0,g,_,i.data)}}else{T?D&&n.texSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,0,0,0,g,_,m[t]):n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,0,x,g,_,m[t]);for(let r=0;r<k.length;r++){let i=k[r];T?D&&n.texSubImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r+1,0,0,g,_,i.image[t]):n.texImage2D(e.TEXTURE_CUBE_MAP_POSITIVE_X+t,r+1,x,g,_,i.image[t])}}}y(o)&&o.mipmapsAutoUpdate===!0&&b(e.TEXTURE_CUBE_MAP),u.__version=l.version,o.onUpdate&&o.onUpdate(o)}t.__version=o.version}function he(t,i,o,c,l,u){let d=a.convert(o.format,o.colorSpace),f=a.convert(o.type),p=S(o.internalFormat,d,f,o.normalized,o.colorSpace),m=r.get(i),h=r.get(o);if(h.__renderTarget=i,!m.__hasExternalTextures){let t=Math.max(1,i.width>>u),r=Math.max(1,i.height>>u);l===e.TEXTURE_3D||l===e.TEXTURE_2D_ARRAY?n.texImage3D(l,u,p,t,r,i.depth,0,d,f,null):n.texImage2D(l,u,p,t,r,0,d,f,null)}n.bindFramebuffer(e.FRAMEBUFFER,t),Ce(i)?s.framebufferTexture2DMultisampleEXT(e.FRAMEBUFFER,c,l,h.__webglTexture,0,B(i)):(l===e.TEXTURE_2D||l>=e.TEXTURE_CUBE_MAP_POSITIVE_X&&l<=e.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&e.framebufferTexture2D(e.FRAMEBUFFER,c,l,h.__webglTexture,u),n.bindFramebuffer(e.FRAMEBUFFER,null)}function ge(t,n,r){if(e.bindRenderbuffer(e.RENDERBUFFER,t),n.depthBuffer){let i=n.depthTexture,a=i&&i.isDepthTexture?i.type:null,o=C(n.stencilBuffer,a),c=n.stencilBuffer?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT;Ce(n)?s.renderbufferStorageMultisampleEXT(e.RENDERBUFFER,B(n),o,n.width,n.height):r?e.renderbufferStorageMultisample(e.RENDERBUFFER,B(n),o,n.width,n.height):e.renderbufferStorage(e.RENDERBUFFER,o,n.width,n.height),e.framebufferRenderbuffer(e.FRAMEBUFFER,c,e.RENDERBUFFER,t)}else{let t=n.textures;for(let i=0;i<t.length;i++){let o=t[i],c=a.convert(o.format,o.colorSpace),l=a.convert(o.type),u=S(o.internalFormat,c,l,o.normalized,o.colorSpace);Ce(n)?s.renderbufferStorageMultisampleEXT(e.RENDERBUFFER,B(n),u,n.width,n.height):r?e.renderbufferStorageMultisample(e.RENDERBUFFER,B(n),u,n.width,n.height):e.renderbufferStorage(e.RENDERBUFFER,u,n.width,n.height)}}e.bindRenderbuffer(e.RENDERBUFFER,null)}function _e(t,i,a){let o=i.isWebGLCubeRenderTarget===!0;if(n.bindFramebuffer(e.FRAMEBUFFER,t),!(i.depthTexture&&i.depthTexture.isDepthTexture))throw Error(`THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.`);let c=r.get(i.depthTexture);c.__renderTarget=i;let l=o?i.depthTexture.image[0]:i.depthTexture.image;c.__webglTexture&&l.width===i.width&&l.height===i.height||(l.width=i.width,l.height=i.height,i.depthTexture.needsUpdate=!0),o?oe(i.depthTexture,0):ie(i.depthTexture,0);let u=c.__webglTexture,d=B(i),f=o?e.TEXTURE_CUBE_MAP_POSITIVE_X+a:e.TEXTURE_2D,p=i.depthTexture.format===1027?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT;if(i.depthTexture.format===1026)Ce(i)?s.framebufferTexture2DMultisampleEXT(e.FRAMEBUFFER,p,f,u,0,d):e.framebufferTexture2D(e.FRAMEBUFFER,p,f,u,0);else if(i.depthTexture.format===1027)Ce(i)?s.framebufferTexture2DMultisampleEXT(e.FRAMEBUFFER,p,f,u,0,d):e.framebufferTexture2D(e.FRAMEBUFFER,p,f,u,0);else throw Error(`THREE.WebGLTextures: Unknown depthTexture format.`)}function ve(t){let i=r.get(t),a=t.isWebGLCubeRenderTarget===!0;if(i.__boundDepthTexture!==t.depthTexture){let e=t.depthTexture;if(i.__depthDisposeCallback&&i.__depthDisposeCallback(),e){let t=()=>{delete i.__boundDepthTexture,delete i.__depthDisposeCallback,e.removeEventListener(`dispose`,t)};e.addEventListener(`dispose`,t),i.__depthDisposeCallback=t}i.__boundDepthTexture=e}if(t.depthTexture&&!i.__autoAllocateDepthBuffer){if(a)for(let e=0;e<6;e++)_e(i.__webglFramebuffer[e],t,e);else t.texture.mipmaps.length>0?_e(i.__webglFramebuffer[0],t,0):_e(i.__webglFramebuffer,t,0)}else if(a){i.__webglDepthbuffer=[];for(let r=0;r<6;r++)if(n.bindFramebuffer(e.FRAMEBUFFER,i.__webglFramebuffer[r]),i.__webglDepthbuffer[r]===void 0)i.__webglDepthbuffer[r]=e.createRenderbuffer(),ge(i.__webglDepthbuffer[r],t,!1);else{let n=t.stencilBuffer?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT,a=i.__webglDepthbuffer[r];e.bindRenderbuffer(e.RENDERBUFFER,a),e.framebufferRenderbuffer(e.FRAMEBUFFER,n,e.RENDERBUFFER,a)}}else if(t.texture.mipmaps.length>0?n.bindFramebuffer(e.FRAMEBUFFER,i.__webglFramebuffer[0]):n.bindFramebuffer(e.FRAMEBUFFER,i.__webglFramebuffer),i.__webglDepthbuffer===void 0)i.__webglDepthbuffer=e.createRenderbuffer(),ge(i.__webglDepthbuffer,t,!1);else{let n=t.stencilBuffer?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT,r=i.__webglDepthbuffer;e.bindRenderbuffer(e.RENDERBUFFER,r),e.framebufferRenderbuffer(e.FRAMEBUFFER,n,e.RENDERBUFFER,r)}n.bindFramebuffer(e.FRAMEBUFFER,null)}function ye(t,n,i){let a=r.get(t);n!==void 0&&he(a.__webglFramebuffer,t,t.texture,e.COLOR_ATTACHMENT0,e.TEXTURE_2D,0),i!==void 0&&ve(t)}function z(t){let i=t.texture,s=r.get(t),c=r.get(i);t.addEventListener(`dispose`,O),T(t);let l=t.textures,u=t.isWebGLCubeRenderTarget===!0,d=l.length>1;if(d||(c.__webglTexture===void 0&&(c.__webglTexture=e.createTexture()),c.__version=i.version,o.memory.textures++),u){s.__webglFramebuffer=[];for(let t=0;t<6;t++)if(i.mipmaps.length>0){s.__webglFramebuffer[t]=[];for(let n=0;n<i.mipmaps.length;n++)s.__webglFramebuffer[t][n]=e.createFramebuffer()}else s.__webglFramebuffer[t]=e.createFramebuffer()}else{if(i.mipmaps.length>0){s.__webglFramebuffer=[];for(let t=0;t<i.mipmaps.length;t++)s.__webglFramebuffer[t]=e.createFramebuffer()}else s.__webglFramebuffer=e.createFramebuffer();if(d)for(let t=0,n=l.length;t<n;t++){let n=r.get(l[t]);n.__webglTexture===void 0&&(n.__webglTexture=e.createTexture(),o.memory.textures++)}if(t.samples>0&&Ce(t)===!1){s.__webglMultisampledFramebuffer=e.createFramebuffer(),s.__webglColorRenderbuffer=[],n.bindFramebuffer(e.FRAMEBUFFER,s.__webglMultisampledFramebuffer);for(let n=0;n<l.length;n++){let r=l[n];s.__webglColorRenderbuffer[n]=e.createRenderbuffer(),e.bindRenderbuffer(e.RENDERBUFFER,s.__webglColorRenderbuffer[n]);let i=a.convert(r.format,r.colorSpace),o=a.convert(r.type),c=S(r.internalFormat,i,o,r.normalized,r.colorSpace,t.isXRRenderTarget===!0),u=B(t);e.renderbufferStorageMultisample(e.RENDERBUFFER,u,c,t.width,t.height),e.framebufferRenderbuffer(e.FRAMEBUFFER,e.COLOR_ATTACHMENT0+n,e.RENDERBUFFER,s.__webglColorRenderbuffer[n])}e.bindRenderbuffer(e.RENDERBUFFER,null),t.depthBuffer&&(s.__webglDepthRenderbuffer=e.createRenderbuffer(),ge(s.__webglDepthRenderbuffer,t,!0)),n.bindFramebuffer(e.FRAMEBUFFER,null)}}if(u){n.bindTexture(e.TEXTURE_CUBE_MAP,c.__webglTexture),le(e.TEXTURE_CUBE_MAP,i);for(let n=0;n<6;n++)if(i.mipmaps.length>0)for(let r=0;r<i.mipmaps.length;r++)he(s.__webglFramebuffer[n][r],t,i,e.COLOR_ATTACHMENT0,e.TEXTURE_CUBE_MAP_POSITIVE_X+n,r);else he(s.__webglFramebuffer[n],t,i,e.COLOR_ATTACHMENT0,e.TEXTURE_CUBE_MAP_POSITIVE_X+n,0);y(i)?b(e.TEXTURE_CUBE_MAP):i.mipmaps.length>0&&e.texParameteri(e.TEXTURE_CUBE_MAP,e.TEXTURE_MAX_LEVEL,i.mipmaps.length-1),n.unbindTexture()}else if(d){for(let i=0,a=l.length;i<a;i++){let a=l[i],o=r.get(a),c=e.TEXTURE_2D;(t.isWebGL3DRenderTarget||t.isWebGLArrayRenderTarget)&&(c=t.isWebGL3DRenderTarget?e.TEXTURE_3D:e.TEXTURE_2D_ARRAY),n.bindTexture(c,o.__webglTexture),le(c,a),he(s.__webglFramebuffer,t,a,e.COLOR_ATTACHMENT0+i,c,0),y(a)&&b(c)}n.unbindTexture()}else{let r=e.TEXTURE_2D;if((t.isWebGL3DRenderTarget||t.isWebGLArrayRenderTarget)&&(r=t.isWebGL3DRenderTarget?e.TEXTURE_3D:e.TEXTURE_2D_ARRAY),n.bindTexture(r,c.__webglTexture),le(r,i),i.mipmaps.length>0)for(let n=0;n<i.mipmaps.length;n++)he(s.__webglFramebuffer[n],t,i,e.COLOR_ATTACHMENT0,r,n);else he(s.__webglFramebuffer,t,i,e.COLOR_ATTACHMENT0,r,0);y(i)?b(r):i.mipmaps.length>0&&e.texParameteri(r,e.TEXTURE_MAX_LEVEL,i.mipmaps.length-1),n.unbindTexture()}t.depthBuffer&&ve(t)}function be(e){let t=e.textures;for(let i=0,a=t.length;i<a;i++){let a=t[i];if(y(a)&&a.mipmapsAutoUpdate===!0){let t=x(e),i=r.get(a).__webglTexture;n.bindTexture(t,i),b(t),n.unbindTexture()}}}let xe=[];function Se(t){if(t.samples>0){if(Ce(t)===!1){let i=t.textures,a=t.width,o=t.height,s=e.COLOR_BUFFER_BIT,l=t.stencilBuffer?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT,u=r.get(t),d=i.length>1;if(d)for(let t=0;t<i.length;t++)n.bindFramebuffer(e.FRAMEBUFFER,u.__webglMultisampledFramebuffer),e.framebufferRenderbuffer(e.FRAMEBUFFER,e.COLOR_ATTACHMENT0+t,e.RENDERBUFFER,null),n.bindFramebuffer(e.FRAMEBUFFER,u.__webglFramebuffer),e.framebufferTexture2D(e.DRAW_FRAMEBUFFER,e.COLOR_ATTACHMENT0+t,e.TEXTURE_2D,null,0);n.bindFramebuffer(e.READ_FRAMEBUFFER,u.__webglMultisampledFramebuffer),t.texture.mipmaps.length>0?n.bindFramebuffer(e.DRAW_FRAMEBUFFER,u.__webglFramebuffer[0]):n.bindFramebuffer(e.DRAW_FRAMEBUFFER,u.__webglFramebuffer);for(let n=0;n<i.length;n++){if(t.resolveDepthBuffer&&(t.depthBuffer&&(s|=e.DEPTH_BUFFER_BIT),t.stencilBuffer&&t.resolveStencilBuffer&&(s|=e.STENCIL_BUFFER_BIT)),d){e.framebufferRenderbuffer(e.READ_FRAMEBUFFER,e.COLOR_ATTACHMENT0,e.RENDERBUFFER,u.__webglColorRenderbuffer[n]);let t=r.get(i[n]).__webglTexture;e.framebufferTexture2D(e.DRAW_FRAMEBUFFER,e.COLOR_ATTACHMENT0,e.TEXTURE_2D,t,0)}e.blitFramebuffer(0,0,a,o,0,0,a,o,s,e.NEAREST),c===!0&&(xe.length=0,xe.push(e.COLOR_ATTACHMENT0+n),t.depthBuffer&&t.storeMultisampledDepthBuffer===!1&&xe.push(l),e.invalidateFramebuffer(e.READ_FRAMEBUFFER,xe))}if(n.bindFramebuffer(e.READ_FRAMEBUFFER,null),n.bindFramebuffer(e.DRAW_FRAMEBUFFER,null),d)for(let t=0;t<i.length;t++){n.bindFramebuffer(e.FRAMEBUFFER,u.__webglMultisampledFramebuffer),e.framebufferRenderbuffer(e.FRAMEBUFFER,e.COLOR_ATTACHMENT0+t,e.RENDERBUFFER,u.__webglColorRenderbuffer[t]);let a=r.get(i[t]).__webglTexture;n.bindFramebuffer(e.FRAMEBUFFER,u.__webglFramebuffer),e.framebufferTexture2D(e.DRAW_FRAMEBUFFER,e.COLOR_ATTACHMENT0+t,e.TEXTURE_2D,a,0)}n.bindFramebuffer(e.DRAW_FRAMEBUFFER,u.__webglMultisampledFramebuffer)}else if(t.depthBuffer&&t.storeMultisampledDepthBuffer===!1&&c){let n=t.stencilBuffer?e.DEPTH_STENCIL_ATTACHMENT:e.DEPTH_ATTACHMENT;e.invalidateFramebuffer(e.DRAW_FRAMEBUFFER,[n])}}}function B(e){return Math.min(i.maxSamples,e.samples)}function Ce(e){let n=r.get(e);return e.samples>0&&t.has(`WEBGL_multisampled_render_to_texture`)===!0&&n.__useRenderToTexture!==!1}function V(e){let t=o.render.frame;u.get(e)!==t&&(u.set(e,t),e.update())}function H(e,t){let n=e.colorSpace,r=e.format,i=e.type;return e.isCompressedTexture===!0||e.isVideoTexture===!0||n!==`srgb-linear`&&n!==``&&(X.getTransfer(n)===`srgb`?(r!==1023||i!==1009)&&W(`WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType.`):G(`WebGLTextures: Unsupported texture color space:`,n)),t}function we(e){return typeof HTMLImageElement<`u`&&e instanceof HTMLImageElement?(l.width=e.naturalWidth||e.width,l.height=e.naturalHeight||e.height):typeof VideoFrame<`u`&&e instanceof VideoFrame?(l.width=e.displayWidth,l.height=e.displayHeight):(l.width=e.width,l.height=e.height),l}this.allocateTextureUnit=ne,this.resetTextureUnits=I,this.getTextureUnits=ee,this.setTextureUnits=te,this.setTexture2D=ie,this.setTexture2DArray=ae,this.setTexture3D=L,this.setTextureCube=oe,this.rebindTextures=ye,this.setupRenderTarget=z,this.updateRenderTargetMipmap=be,this.updateMultisampleRenderTarget=Se,this.setupDepthRenderbuffer=ve,this.setupFrameBufferTexture=he,this.useMultisampledRTT=Ce,this.dispose=j}function wu(e,t){function n(n,r=``){let i,a=X.getTransfer(r);if(n===1009)return e.UNSIGNED_BYTE;if(n===1017)return e.UNSIGNED_SHORT_4_4_4_4;if(n===1018)return e.UNSIGNED_SHORT_5_5_5_1;if(n===35902)return e.UNSIGNED_INT_5_9_9_9_REV;if(n===35899)return e.UNSIGNED_INT_10F_11F_11F_REV;if(n===1010)return e.BYTE;if(n===1011)return e.SHORT;if(n===1012)return e.UNSIGNED_SHORT;if(n===1013)return e.INT;if(n===1014)return e.UNSIGNED_INT;if(n===1015)return e.FLOAT;if(n===1016)return e.HALF_FLOAT;if(n===1021)return e.ALPHA;if(n===1022)return e.RGB;if(n===1023)return e.RGBA;if(n===1026)return e.DEPTH_COMPONENT;if(n===1027)return e.DEPTH_STENCIL;if(n===1028)return e.RED;if(n===1029)return e.RED_INTEGER;if(n===1030)return e.RG;if(n===1031)return e.RG_INTEGER;if(n===1033)return e.RGBA_INTEGER;if(n===33776||n===33777||n===33778||n===33779){if(a===`srgb`){if(i=t.get(`WEBGL_compressed_texture_s3tc_srgb`),i!==null){if(n===33776)return i.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===33777)return i.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===33778)return i.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===33779)return i.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null}else if(i=t.get(`WEBGL_compressed_texture_s3tc`),i!==null){if(n===33776)return i.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===33777)return i.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===33778)return i.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===33779)return i.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null}if(n===35840||n===35841||n===35842||n===35843){if(i=t.get(`WEBGL_compressed_texture_pvrtc`),i!==null){if(n===35840)return i.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===35841)return i.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===35842)return i.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===35843)return i.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null}if(n===36196||n===37492||n===37496||n===37488||n===37489||n===37490||n===37491){if(i=t.get(`WEBGL_compressed_texture_etc`),i!==null){if(n===36196||n===37492)return a===`srgb`?i.COMPRESSED_SRGB8_ETC2:i.COMPRESSED_RGB8_ETC2;if(n===37496)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:i.COMPRESSED_RGBA8_ETC2_EAC;if(n===37488)return i.COMPRESSED_R11_EAC;if(n===37489)return i.COMPRESSED_SIGNED_R11_EAC;if(n===37490)return i.COMPRESSED_RG11_EAC;if(n===37491)return i.COMPRESSED_SIGNED_RG11_EAC}else return null}if(n===37808||n===37809||n===37810||n===37811||n===37812||n===37813||n===37814||n===37815||n===37816||n===37817||n===37818||n===37819||n===37820||n===37821){if(i=t.get(`WEBGL_compressed_texture_astc`),i!==null){if(n===37808)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:i.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===37809)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:i.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===37810)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:i.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===37811)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:i.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===37812)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:i.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===37813)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:i.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===37814)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:i.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===37815)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:i.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===37816)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:i.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===37817)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:i.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===37818)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:i.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===37819)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:i.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===37820)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:i.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===37821)return a===`srgb`?i.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:i.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null}if(n===36492||n===36494||n===36495){if(i=t.get(`EXT_texture_compression_bptc`),i!==null){if(n===36492)return a===`srgb`?i.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:i.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===36494)return i.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===36495)return i.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null}if(n===36283||n===36284||n===36285||n===36286){if(i=t.get(`EXT_texture_compression_rgtc`),i!==null){if(n===36283)return i.COMPRESSED_RED_RGTC1_EXT;if(n===36284)return i.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===36285)return i.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===36286)return i.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null}return n===1020?e.UNSIGNED_INT_24_8:e[n]===void 0?null:e[n]}return{convert:n}}var Tu=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,Eu=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,Du=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(e,t){if(this.texture===null){let n=new yo(e.texture);(e.depthNear!==t.depthNear||e.depthFar!==t.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=n}}getMesh(e){if(this.texture!==null&&this.mesh===null){let t=e.cameras[0].viewport,n=new Ao({vertexShader:Tu,fragmentShader:Eu,uniforms:{depthColor:{value:this.texture},depthWidth:{value:t.z},depthHeight:{value:t.w}}});this.mesh=new za(new xo(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Ou=class extends or{constructor(e,t){super();let n=this,r=null,i=1,a=null,o=`local-floor`,s=1,c=null,l=null,u=null,d=null,f=null,p=null,m=typeof XRWebGLBinding<`u`,h=new Du,g={},_=t.getContextAttributes(),v=null,y=null,b=[],x=[],S=new q,C=null,w=null,T=new ss;T.viewport=new Pr;let E=new ss;E.viewport=new Pr;let D=[T,E],O=new fs,k=null,A=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(e){let t=b[e];return t===void 0&&(t=new hi,b[e]=t),t.getTargetRaySpace()},this.getControllerGrip=function(e){let t=b[e];return t===void 0&&(t=new hi,b[e]=t),t.getGripSpace()},this.getHand=function(e){let t=b[e];return t===void 0&&(t=new hi,b[e]=t),t.getHandSpace()};function j(e){let t=x.indexOf(e.inputSource);if(t===-1)return;let n=b[t];n!==void 0&&(n.update(e.inputSource,e.frame,c||a),n.dispatchEvent({type:e.type,data:e.inputSource}))}function M(){r.removeEventListener(`select`,j),r.removeEventListener(`selectstart`,j),r.removeEventListener(`selectend`,j),r.removeEventListener(`squeeze`,j),r.removeEventListener(`squeezestart`,j),r.removeEventListener(`squeezeend`,j),r.removeEventListener(`end`,M),r.removeEventListener(`inputsourceschange`,N);for(let e=0;e<b.length;e++){let t=x[e];t!==null&&(x[e]=null,b[e].disconnect(t))}k=null,A=null,h.reset();for(let e in g)delete g[e];if(e.setRenderTarget(v),f=null,d=null,u=null,r=null,y=null,te.stop(),n.isPresenting=!1,e.setPixelRatio(C),e.setSize(S.width,S.height,!1),w!==null){let e=w.camera;e.fov=w.fov,e.zoom=w.zoom,e.updateProjectionMatrix(),w=null}n.dispatchEvent({type:`sessionend`})}this.setFramebufferScaleFactor=function(e){i=e,n.isPresenting===!0&&W(`WebXRManager: Cannot change framebuffer scale while presenting.`)},this.setReferenceSpaceType=function(e){o=e,n.isPresenting===!0&&W(`WebXRManager: Cannot change reference space type while presenting.`)},this.getReferenceSpace=function(){return c||a},this.setReferenceSpace=function(e){c=e},this.getBaseLayer=function(){return d===null?f:d},this.getBinding=function(){return u===null&&m&&(u=new XRWebGLBinding(r,t)),u},this.getFrame=function(){return p},this.getSession=function(){return r},this.setSession=async function(l){if(r=l,r!==null){if(v=e.getRenderTarget(),r.addEventListener(`select`,j),r.addEventListener(`selectstart`,j),r.addEventListener(`selectend`,j),r.addEventListener(`squeeze`,j),r.addEventListener(`squeezestart`,j),r.addEventListener(`squeezeend`,j),r.addEventListener(`end`,M),r.addEventListener(`inputsourceschange`,N),_.xrCompatible!==!0&&await t.makeXRCompatible(),C=e.getPixelRatio(),e.getSize(S),m&&`createProjectionLayer`in XRWebGLBinding.prototype){let n=null,a=null,o=null;_.depth&&(o=_.stencil?t.DEPTH24_STENCIL8:t.DEPTH_COMPONENT24,n=_.stencil?Gt:Wt,a=_.stencil?Rt:Nt);let s={colorFormat:t.RGBA8,depthFormat:o,scaleFactor:i};u=this.getBinding(),d=u.createProjectionLayer(s),r.updateRenderState({layers:[d]}),e.setPixelRatio(1),e.setSize(d.textureWidth,d.textureHeight,!1),y=new Ir(d.textureWidth,d.textureHeight,{format:Ut,type:Ot,depthTexture:new _o(d.textureWidth,d.textureHeight,a,void 0,void 0,void 0,void 0,void 0,void 0,n),stencilBuffer:_.stencil,colorSpace:e.outputColorSpace,samples:_.antialias?4:0,resolveDepthBuffer:d.ignoreDepthValues===!1,resolveStencilBuffer:d.ignoreDepthValues===!1,storeMultisampledDepthBuffer:d.ignoreDepthValues===!1,storeMultisampledStencilBuffer:d.ignoreDepthValues===!1})}else{let n={antialias:_.antialias,alpha:!0,depth:_.depth,stencil:_.stencil,framebufferScaleFactor:i};f=new XRWebGLLayer(r,t,n),r.updateRenderState({baseLayer:f}),e.setPixelRatio(1),e.setSize(f.framebufferWidth,f.framebufferHeight,!1),y=new Ir(f.framebufferWidth,f.framebufferHeight,{format:Ut,type:Ot,colorSpace:e.outputColorSpace,stencilBuffer:_.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}y.isXRRenderTarget=!0,this.setFoveation(s),c=null,a=await r.requestReferenceSpace(o),te.setContext(r),te.start(),n.isPresenting=!0,n.dispatchEvent({type:`sessionstart`})}},this.getEnvironmentBlendMode=function(){if(r!==null)return r.environmentBlendMode},this.getDepthTexture=function(){return h.getDepthTexture()};function N(e){for(let t=0;t<e.removed.length;t++){let n=e.removed[t],r=x.indexOf(n);r>=0&&(x[r]=null,b[r].disconnect(n))}for(let t=0;t<e.added.length;t++){let n=e.added[t],r=x.indexOf(n);if(r===-1){for(let e=0;e<b.length;e++)if(e>=x.length){x.push(n),r=e;break}else if(x[e]===null){x[e]=n,r=e;break}if(r===-1)break}let i=b[r];i&&i.connect(n)}}function P(e,t){t===null?e.matrixWorld.copy(e.matrix):e.matrixWorld.multiplyMatrices(t.matrixWorld,e.matrix),e.matrixWorldInverse.copy(e.matrixWorld).invert()}this.updateCamera=function(e){if(r===null)return;let t=e.near,n=e.far;h.texture!==null&&(h.depthNear>0&&(t=h.depthNear),h.depthFar>0&&(n=h.depthFar)),O.near=E.near=T.near=t,O.far=E.far=T.far=n,(k!==O.near||A!==O.far)&&(r.updateRenderState({depthNear:O.near,depthFar:O.far}),k=O.near,A=O.far),O.layers.mask=e.layers.mask|6,T.layers.mask=O.layers.mask&-5,E.layers.mask=O.layers.mask&-3;let i=e.parent,a=O.cameras;P(O,i);for(let e=0;e<a.length;e++)P(a[e],i);O.projectionMatrix.copy(T.projectionMatrix),O.projectionMatrixInverse.copy(T.projectionMatrixInverse),w===null&&e.isPerspectiveCamera&&(w={camera:e,fov:e.fov,zoom:e.zoom}),F(e,O,i)};function F(e,t,n){n===null?e.matrix.copy(t.matrixWorld):(e.matrix.copy(n.matrixWorld),e.matrix.invert(),e.matrix.multiply(t.matrixWorld)),e.matrix.decompose(e.position,e.quaternion,e.scale),e.updateMatrixWorld(!0),e.projectionMatrix.copy(t.projectionMatrix),e.projectionMatrixInverse.copy(t.projectionMatrixInverse),e.isPerspectiveCamera&&(e.fov=lr*2*Math.atan(1/e.projectionMatrix.elements[5]),e.zoom=1)}this.getCamera=function(){return O},this.getFoveation=function(){if(d!==null||f!==null)return s},this.setFoveation=function(e){s=e,d!==null&&(d.fixedFoveation=e),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=e)},this.hasDepthSensing=function(){return h.texture!==null},this.getDepthSensingMesh=function(){return h.getMesh(O)},this.getCameraTexture=function(e){return g[e]};let I=null;function ee(t,i){if(l=i.getViewerPose(c||a),p=i,l!==null){let t=l.views;f!==null&&(e.setRenderTargetFramebuffer(y,f.framebuffer),e.setRenderTarget(y));let i=!1;t.length!==O.cameras.length&&(O.cameras.length=0,i=!0);for(let n=0;n<t.length;n++){let r=t[n],a=null;if(f!==null)a=f.getViewport(r);else{let t=u.getViewSubImage(d,r);a=t.viewport,n===0&&(e.setRenderTargetTextures(y,t.colorTexture,t.depthStencilTexture),e.setRenderTarget(y))}let o=D[n];o===void 0&&(o=new ss,o.layers.enable(n),o.viewport=new Pr,D[n]=o),o.matrix.fromArray(r.transform.matrix),o.matrix.decompose(o.position,o.quaternion,o.scale),o.projectionMatrix.fromArray(r.projectionMatrix),o.projectionMatrixInverse.copy(o.projectionMatrix).invert(),o.viewport.set(a.x,a.y,a.width,a.height),n===0&&(O.matrix.copy(o.matrix),O.matrix.decompose(O.position,O.quaternion,O.scale)),i===!0&&O.cameras.push(o)}let a=r.enabledFeatures;if(a&&a.includes(`depth-sensing`)&&r.depthUsage==`gpu-optimized`&&m){u=n.getBinding();let e=u.getDepthInformation(t[0]);e&&e.isValid&&e.texture&&h.init(e,r.renderState)}if(a&&a.includes(`camera-access`)&&m){e.state.unbindTexture(),u=n.getBinding();for(let e=0;e<t.length;e++){let n=t[e].camera;if(n){let e=g[n];e||(e=new yo,g[n]=e);let t=u.getCameraImage(n);e.sourceTexture=t}}}}for(let e=0;e<b.length;e++){let t=x[e],n=b[e];t!==null&&n!==void 0&&n.update(t,i,c||a)}I&&I(t,i),i.detectedPlanes&&n.dispatchEvent({type:`planesdetected`,data:i}),p=null}let te=new Ds;te.setAnimationLoop(ee),this.setAnimationLoop=function(e){I=e},this.dispose=function(){}}},ku=new zr,Au=new Y;Au.set(-1,0,0,0,1,0,0,0,1);function ju(e,t){function n(e,t){e.matrixAutoUpdate===!0&&e.updateMatrix(),t.value.copy(e.matrix)}function r(t,n){n.color.getRGB(t.fogColor.value,Eo(e)),n.isFog?(t.fogNear.value=n.near,t.fogFar.value=n.far):n.isFogExp2&&(t.fogDensity.value=n.density)}function i(e,t,n,r,i){t.isNodeMaterial?t.uniformsNeedUpdate=!1:t.isMeshBasicMaterial?a(e,t):t.isMeshLambertMaterial?(a(e,t),t.envMap&&(e.envMapIntensity.value=t.envMapIntensity)):t.isMeshToonMaterial?(a(e,t),d(e,t)):t.isMeshPhongMaterial?(a(e,t),u(e,t),t.envMap&&(e.envMapIntensity.value=t.envMapIntensity)):t.isMeshStandardMaterial?(a(e,t),f(e,t),t.isMeshPhysicalMaterial&&p(e,t,i)):t.isMeshMatcapMaterial?(a(e,t),m(e,t)):t.isMeshDepthMaterial?a(e,t):t.isMeshDistanceMaterial?(a(e,t),h(e,t)):t.isMeshNormalMaterial?a(e,t):t.isLineBasicMaterial?(o(e,t),t.isLineDashedMaterial&&s(e,t)):t.isPointsMaterial?c(e,t,n,r):t.isSpriteMaterial?l(e,t):t.isShadowMaterial?(e.color.value.copy(t.color),e.opacity.value=t.opacity):t.isShaderMaterial&&(t.uniformsNeedUpdate=!1)}function a(e,r){e.opacity.value=r.opacity,r.color&&e.diffuse.value.copy(r.color),r.emissive&&e.emissive.value.copy(r.emissive).multiplyScalar(r.emissiveIntensity),r.map&&(e.map.value=r.map,n(r.map,e.mapTransform)),r.alphaMap&&(e.alphaMap.value=r.alphaMap,n(r.alphaMap,e.alphaMapTransform)),r.bumpMap&&(e.bumpMap.value=r.bumpMap,n(r.bumpMap,e.bumpMapTransform),e.bumpScale.value=r.bumpScale,r.side===1&&(e.bumpScale.value*=-1)),r.normalMap&&(e.normalMap.value=r.normalMap,n(r.normalMap,e.normalMapTransform),e.normalScale.value.copy(r.normalScale),r.side===1&&e.normalScale.value.negate()),r.displacementMap&&(e.displacementMap.value=r.displacementMap,n(r.displacementMap,e.displacementMapTransform),e.displacementScale.value=r.displacementScale,e.displacementBias.value=r.displacementBias),r.emissiveMap&&(e.emissiveMap.value=r.emissiveMap,n(r.emissiveMap,e.emissiveMapTransform)),r.specularMap&&(e.specularMap.value=r.specularMap,n(r.specularMap,e.specularMapTransform)),r.alphaTest>0&&(e.alphaTest.value=r.alphaTest);let i=t.get(r),a=i.envMap,o=i.envMapRotation;a&&(e.envMap.value=a,e.envMapRotation.value.setFromMatrix4(ku.makeRotationFromEuler(o)).transpose(),a.isCubeTexture&&a.isRenderTargetTexture===!1&&e.envMapRotation.value.premultiply(Au),e.reflectivity.value=r.reflectivity,e.ior.value=r.ior,e.refractionRatio.value=r.refractionRatio),r.lightMap&&(e.lightMap.value=r.lightMap,e.lightMapIntensity.value=r.lightMapIntensity,n(r.lightMap,e.lightMapTransform)),r.aoMap&&(e.aoMap.value=r.aoMap,e.aoMapIntensity.value=r.aoMapIntensity,n(r.aoMap,e.aoMapTransform))}function o(e,t){e.diffuse.value.copy(t.color),e.opacity.value=t.opacity,t.map&&(e.map.value=t.map,n(t.map,e.mapTransform))}function s(e,t){e.dashSize.value=t.dashSize,e.totalSize.value=t.dashSize+t.gapSize,e.scale.value=t.scale}function c(e,t,r,i){e.diffuse.value.copy(t.color),e.opacity.value=t.opacity,e.size.value=t.size*r,e.scale.value=i*.5,t.map&&(e.map.value=t.map,n(t.map,e.uvTransform)),t.alphaMap&&(e.alphaMap.value=t.alphaMap,n(t.alphaMap,e.alphaMapTransform)),t.alphaTest>0&&(e.alphaTest.value=t.alphaTest)}function l(e,t){e.diffuse.value.copy(t.color),e.opacity.value=t.opacity,e.rotation.value=t.rotation,t.map&&(e.map.value=t.map,n(t.map,e.mapTransform)),t.alphaMap&&(e.alphaMap.value=t.alphaMap,n(t.alphaMap,e.alphaMapTransform)),t.alphaTest>0&&(e.alphaTest.value=t.alphaTest)}function u(e,t){e.specular.value.copy(t.specular),e.shininess.value=Math.max(t.shininess,1e-4)}function d(e,t){t.gradientMap&&(e.gradientMap.value=t.gradientMap)}function f(e,t){e.metalness.value=t.metalness,t.metalnessMap&&(e.metalnessMap.value=t.metalnessMap,n(t.metalnessMap,e.metalnessMapTransform)),e.roughness.value=t.roughness,t.roughnessMap&&(e.roughnessMap.value=t.roughnessMap,n(t.roughnessMap,e.roughnessMapTransform)),t.envMap&&(e.envMapIntensity.value=t.envMapIntensity)}function p(e,t,r){e.ior.value=t.ior,t.diffuseRoughness>0&&(e.diffuseRoughness.value=t.diffuseRoughness,t.diffuseRoughnessMap&&(e.diffuseRoughnessMap.value=t.diffuseRoughnessMap,n(t.diffuseRoughnessMap,e.diffuseRoughnessMapTransform))),t.sheen>0&&(e.sheenColor.value.copy(t.sheenColor).multiplyScalar(t.sheen),e.sheenRoughness.value=t.sheenRoughness,t.sheenColorMap&&(e.sheenColorMap.value=t.sheenColorMap,n(t.sheenColorMap,e.sheenColorMapTransform)),t.sheenRoughnessMap&&(e.sheenRoughnessMap.value=t.sheenRoughnessMap,n(t.sheenRoughnessMap,e.sheenRoughnessMapTransform))),t.clearcoat>0&&(e.clearcoat.value=t.clearcoat,e.clearcoatRoughness.value=t.clearcoatRoughness,t.clearcoatMap&&(e.clearcoatMap.value=t.clearcoatMap,n(t.clearcoatMap,e.clearcoatMapTransform)),t.clearcoatRoughnessMap&&(e.clearcoatRoughnessMap.value=t.clearcoatRoughnessMap,n(t.clearcoatRoughnessMap,e.clearcoatRoughnessMapTransform)),t.clearcoatNormalMap&&(e.clearcoatNormalMap.value=t.clearcoatNormalMap,n(t.clearcoatNormalMap,e.clearcoatNormalMapTransform),e.clearcoatNormalScale.value.copy(t.clearcoatNormalScale),t.side===1&&e.clearcoatNormalScale.value.negate())),t.dispersion>0&&(e.dispersion.value=t.dispersion),t.retroreflectivity>0&&(e.retroreflectivity.value=t.retroreflectivity),t.iridescence>0&&(e.iridescence.value=t.iridescence,e.iridescenceIOR.value=t.iridescenceIOR,e.iridescenceThicknessMinimum.value=t.iridescenceThicknessMinimum,e.iridescenceThicknessMaximum.value=t.iridescenceThicknessMaximum,t.iridescenceMap&&(e.iridescenceMap.value=t.iridescenceMap,n(t.iridescenceMap,e.iridescenceMapTransform)),t.iridescenceThicknessMap&&(e.iridescenceThicknessMap.value=t.iridescenceThicknessMap,n(t.iridescenceThicknessMap,e.iridescenceThicknessMapTransform))),t.transmission>0&&(e.transmission.value=t.transmission,e.transmissionSamplerMap.value=r.texture,e.transmissionSamplerSize.value.set(r.width,r.height),t.transmissionMap&&(e.transmissionMap.value=t.transmissionMap,n(t.transmissionMap,e.transmissionMapTransform)),e.thickness.value=t.thickness,t.thicknessMap&&(e.thicknessMap.value=t.thicknessMap,n(t.thicknessMap,e.thicknessMapTransform)),e.attenuationDistance.value=t.attenuationDistance,e.attenuationColor.value.copy(t.attenuationColor)),t.anisotropy>0&&(e.anisotropyVector.value.set(t.anisotropy*Math.cos(t.anisotropyRotation),t.anisotropy*Math.sin(t.anisotropyRotation)),t.anisotropyMap&&(e.anisotropyMap.value=t.anisotropyMap,n(t.anisotropyMap,e.anisotropyMapTransform))),e.specularIntensity.value=t.specularIntensity,e.specularColor.value.copy(t.specularColor),t.specularColorMap&&(e.specularColorMap.value=t.specularColorMap,n(t.specularColorMap,e.specularColorMapTransform)),t.specularIntensityMap&&(e.specularIntensityMap.value=t.specularIntensityMap,n(t.specularIntensityMap,e.specularIntensityMapTransform))}function m(e,t){t.matcap&&(e.matcap.value=t.matcap)}function h(e,n){let r=t.get(n).light;e.referencePosition.value.setFromMatrixPosition(r.matrixWorld),e.nearDistance.value=r.shadow.camera.near,e.farDistance.value=r.shadow.camera.far}return{refreshFogUniforms:r,refreshMaterialUniforms:i}}function Mu(e,t,n,r){let i={},a={};function o(e,t){let n=t.program;r.uniformBlockBinding(e,n,i[e.id])}function s(e,n){let o=i[e.id];o===void 0&&(m(e),o=c(e),i[e.id]=o,e.addEventListener(`dispose`,g));let s=n.program;r.updateUBOMapping(e,s);let u=t.render.frame;a[e.id]!==u&&(l(e),a[e.id]=u)}function c(t){let n=e.createBuffer(),r=t.__size,i=t.usage;return e.bindBuffer(e.UNIFORM_BUFFER,n),e.bufferData(e.UNIFORM_BUFFER,r,i),e.bindBuffer(e.UNIFORM_BUFFER,null),n}function l(t){let n=i[t.id],r=t.uniforms,a=t.__cache;e.bindBuffer(e.UNIFORM_BUFFER,n);for(let e=0,t=r.length;e<t;e++){let t=r[e];if(Array.isArray(t))for(let n=0,r=t.length;n<r;n++)u(t[n],e,n,a);else u(t,e,0,a)}e.bindBuffer(e.UNIFORM_BUFFER,null)}function u(t,n,r,i){if(f(t,n,r,i)===!0){let n=t.__offset,r=t.value;if(Array.isArray(r)){let e=0;for(let n=0;n<r.length;n++){let i=r[n],a=h(i,!0);d(i,t.__data,e),e+=a.storage/Float32Array.BYTES_PER_ELEMENT}}else d(r,t.__data,0);e.bufferSubData(e.UNIFORM_BUFFER,n,t.__data)}}function d(e,t,n){typeof e==`number`||typeof e==`boolean`?t[n]=e:e.isMatrix3?(t[n]=e.elements[0],t[n+1]=e.elements[1],t[n+2]=e.elements[2],t[n+3]=0,t[n+4]=e.elements[3],t[n+5]=e.elements[4],t[n+6]=e.elements[5],t[n+7]=0,t[n+8]=e.elements[6],t[n+9]=e.elements[7],t[n+10]=e.elements[8],t[n+11]=0):ArrayBuffer.isView(e)?t.set(e.subarray(0,t.length-n),n):e.toArray(t,n)}function f(e,t,n,r){let i=e.value,a=t+`_`+n;if(Array.isArray(i)){r[a]===void 0&&(r[a]=[]);let e=r[a],t=!1;for(let n=0;n<i.length;n++)p(i[n],e,n)===!0&&(t=!0);return t}return p(i,r,a)}function p(e,t,n){if(t[n]===void 0)return t[n]=typeof e==`number`||typeof e==`boolean`?e:ArrayBuffer.isView(e)?e.slice():e.clone(),!0;{let r=t[n];if(typeof e==`number`||typeof e==`boolean`){if(r!==e)return t[n]=e,!0}else if(ArrayBuffer.isView(e))return!0;else if(r.equals(e)===!1)return r.copy(e),!0}return!1}function m(e){let t=e.uniforms,n=0;for(let e=0,r=t.length;e<r;e++){let r=Array.isArray(t[e])?t[e]:[t[e]];for(let i=0,a=r.length;i<a;i++){let a=r[i],o=Array.isArray(a.value)?a.value:[a.value],s=Array.isArray(t[e])||Array.isArray(a.value),c=n;for(let e=0,t=o.length;e<t;e++){let t=o[e],r=h(t,s),i=n%16,a=i%r.boundary,l=i+a;n+=a,l!==0&&16-l<r.storage&&(n+=16-l),e===0&&(c=n),n+=r.storage}a.__data=new(a.type===`int`?Int32Array:a.type===`uint`?Uint32Array:Float32Array)((n-c)/Float32Array.BYTES_PER_ELEMENT),a.__offset=c}}let r=n%16;return r>0&&(n+=16-r),e.__size=n,e.__cache={},this}function h(e,t){let n={boundary:0,storage:0};return typeof e==`number`||typeof e==`boolean`?(n.boundary=4,n.storage=4):e.isVector2?(n.boundary=8,n.storage=8):e.isVector3||e.isColor?(n.boundary=16,n.storage=12):e.isVector4?(n.boundary=16,n.storage=16):e.isMatrix3?(n.boundary=16,n.storage=48):e.isMatrix4?(n.boundary=16,n.storage=64):e.isTexture?W(`WebGLRenderer: Texture samplers can not be part of an uniforms group.`):ArrayBuffer.isView(e)?(n.boundary=16,n.storage=e.byteLength):W(`WebGLRenderer: Unsupported uniform value type.`,e),t===!0&&(n.boundary=16,n.storage=Math.ceil(n.storage/16)*16),n}function g(t){let n=t.target;n.removeEventListener(`dispose`,g),e.deleteBuffer(i[n.id]),delete i[n.id],delete a[n.id]}function _(){for(let t in i)e.deleteBuffer(i[t]);i={},a={}}return{bind:o,update:s,dispose:_}}var Nu=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),Pu=null;function Fu(){return Pu===null&&(Pu=new Ha(Nu,16,16,Jt,Ft),Pu.name=`DFG_LUT`,Pu.minFilter=Tt,Pu.magFilter=Tt,Pu.wrapS=bt,Pu.wrapT=bt,Pu.generateMipmaps=!1,Pu.needsUpdate=!0),Pu}var Iu=class{constructor(e={}){let{canvas:t=$n(),context:n=null,depth:r=!0,stencil:i=!1,alpha:a=!1,antialias:o=!1,premultipliedAlpha:s=!0,preserveDrawingBuffer:c=!1,powerPreference:l=`default`,failIfMajorPerformanceCaveat:u=!1,reversedDepthBuffer:d=!1,outputBufferType:f=Ot}=e;this.isWebGLRenderer=!0;let p;if(n!==null){if(typeof WebGLRenderingContext<`u`&&n instanceof WebGLRenderingContext)throw Error(`THREE.WebGLRenderer: WebGL 1 is not supported since r163.`);p=n.getContextAttributes().alpha}else p=a;let m=f,h=new Set([Xt,Yt,qt]),g=new Set([Ot,Nt,jt,Rt,It,Lt]),_=new Uint32Array(4),v=new Int32Array(4),y={textures:[],min:[],max:[],resolution:[]},b=null,x=null,S=[],C=[],w=null;this.domElement=t,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=0,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let T=this,E=!1,D=null,O=null,k=null,A=null;this._outputColorSpace=Hn;let j=0,M=0,N=null,P=-1,F=null,I=new Pr,ee=new Pr,te=null,ne=new Z(0),re=0,ie=t.width,ae=t.height,L=1,oe=null,R=null,se=new Pr(0,0,ie,ae),ce=new Pr(0,0,ie,ae),le=!1,ue=new Ka,de=new Ja,fe=!1,pe=!1,me=new zr,he=new J,ge=new Pr,_e={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},ve=!1;function ye(){return N===null?L:1}let z=n;function be(e,n){return t.getContext(e,n)}let xe,Se,B,Ce,V,H,we,Te,Ee,De,U,Oe,ke,Ae,je,Me,Ne,Pe,Fe,Ie,Le,Re,ze;try{let e={alpha:!0,depth:r,stencil:i,antialias:o,premultipliedAlpha:s,preserveDrawingBuffer:c,powerPreference:l,failIfMajorPerformanceCaveat:u};if(`setAttribute`in t&&t.setAttribute(`data-engine`,`three.js r187`),t.addEventListener(`webglcontextlost`,He,!1),t.addEventListener(`webglcontextrestored`,Ue,!1),t.addEventListener(`webglcontextcreationerror`,We,!1),z===null){let t=`webgl2`;if(z=be(t,e),z===null)throw be(t)?Error(`THREE.WebGLRenderer: Error creating WebGL context with your selected attributes.`):Error(`THREE.WebGLRenderer: Error creating WebGL context.`)}Be()}catch(e){throw t.removeEventListener(`webglcontextlost`,He,!1),t.removeEventListener(`webglcontextrestored`,Ue,!1),t.removeEventListener(`webglcontextcreationerror`,We,!1),G(`WebGLRenderer: `+e.message),e}function Be(){xe=new nc(z),xe.init(),Le=new wu(z,xe),Se=new Is(z,xe,e,Le),B=new Su(z,xe),Se.reversedDepthBuffer&&d&&B.buffers.depth.setReversed(!0),O=z.createFramebuffer(),k=z.createFramebuffer(),A=z.createFramebuffer(),Ce=new ac(z),V=new nu,H=new Cu(z,xe,B,V,Se,Le,Ce),we=new tc(T),Te=new Os(z),Re=new Ps(z,Te),Ee=new rc(z,Te,Ce,Re),De=new sc(z,Ee,Te,Re,Ce),Pe=new oc(z,Se,H),je=new Ls(V),U=new tu(T,we,xe,Se,Re,je),Oe=new ju(T,V),ke=new ou,Ae=new pu(xe),Ne=new Ns(T,we,B,De,p,s),Me=new xu(T,De,Se),ze=new Mu(z,Ce,Se,B),Fe=new Fs(z,xe,Ce),Ie=new ic(z,xe,Ce),Ce.programs=U.programs,T.capabilities=Se,T.extensions=xe,T.properties=V,T.renderLists=ke,T.shadowMap=Me,T.state=B,T.info=Ce}m!==1009&&(w=new lc(m,t.width,t.height,o,r,i));let Ve=new Ou(T,z);this.xr=Ve,this.getContext=function(){return z},this.getContextAttributes=function(){return z.getContextAttributes()},this.forceContextLoss=function(){let e=xe.get(`WEBGL_lose_context`);e&&e.loseContext()},this.forceContextRestore=function(){let e=xe.get(`WEBGL_lose_context`);e&&e.restoreContext()},this.getPixelRatio=function(){return L},this.setPixelRatio=function(e){e!==void 0&&(L=e,this.setSize(ie,ae,!1))},this.getSize=function(e){return e.set(ie,ae)},this.setSize=function(e,n,r=!0){Ve.isPresenting?W(`WebGLRenderer: Can't change size while VR device is presenting.`):(ie=e,ae=n,t.width=Math.floor(e*L),t.height=Math.floor(n*L),r===!0&&(t.style.width=e+`px`,t.style.height=n+`px`),w!==null&&w.setSize(t.width,t.height),this.setViewport(0,0,e,n))},this.getDrawingBufferSize=function(e){return e.set(ie*L,ae*L).floor()},this.setDrawingBufferSize=function(e,n,r){ie=e,ae=n,L=r,t.width=Math.floor(e*r),t.height=Math.floor(n*r),this.setViewport(0,0,e,n)},this.setEffects=function(e){if(m===1009)G(`WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.`);else{if(e){for(let t=0;t<e.length;t++)if(e[t].isOutputPass===!0){W(`WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.`);break}}w.setEffects(e||[])}},this.getCurrentViewport=function(e){return e.copy(I)},this.getViewport=function(e){return e.copy(se)},this.setViewport=function(e,t,n,r){e.isVector4?se.set(e.x,e.y,e.z,e.w):se.set(e,t,n,r),B.viewport(I.copy(se).multiplyScalar(ye()).round())},this.getScissor=function(e){return e.copy(ce)},this.setScissor=function(e,t,n,r){e.isVector4?ce.set(e.x,e.y,e.z,e.w):ce.set(e,t,n,r),B.scissor(ee.copy(ce).multiplyScalar(ye()).round())},this.getScissorTest=function(){return le},this.setScissorTest=function(e){B.setScissorTest(le=e)},this.setOpaqueSort=function(e){oe=e},this.setTransparentSort=function(e){R=e},this.getClearColor=function(e){return e.copy(Ne.getClearColor())},this.setClearColor=function(){Ne.setClearColor(...arguments)},this.getClearAlpha=function(){return Ne.getClearAlpha()},this.setClearAlpha=function(){Ne.setClearAlpha(...arguments)},this.clear=function(e=!0,t=!0,n=!0){let r=0;if(e){let e=!1;if(N!==null){let t=N.texture.format;e=h.has(t)}if(e){let e=N.texture.type,t=g.has(e),n=Ne.getClearColor(),r=Ne.getClearAlpha(),i=n.r,a=n.g,o=n.b;t?(_[0]=i,_[1]=a,_[2]=o,_[3]=r,z.clearBufferuiv(z.COLOR,0,_)):(v[0]=i,v[1]=a,v[2]=o,v[3]=r,z.clearBufferiv(z.COLOR,0,v))}else r|=z.COLOR_BUFFER_BIT}t&&(r|=z.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),n&&(r|=z.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),r!==0&&z.clear(r)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(e){e.setRenderer(this),D=e},this.dispose=function(){t.removeEventListener(`webglcontextlost`,He,!1),t.removeEventListener(`webglcontextrestored`,Ue,!1),t.removeEventListener(`webglcontextcreationerror`,We,!1),Ne.dispose(),ke.dispose(),Ae.dispose(),H.dispose(),V.dispose(),we.dispose(),De.dispose(),Ee.dispose(),Re.dispose(),ze.dispose(),U.dispose(),Ve.dispose(),Ve.removeEventListener(`sessionstart`,Ze),Ve.removeEventListener(`sessionend`,Qe),$e.stop()};function He(e){e.preventDefault(),tr(`WebGLRenderer: Context Lost.`),E=!0}function Ue(){tr(`WebGLRenderer: Context Restored.`),E=!1;let e=Ce.autoReset,t=Me.enabled,n=Me.autoUpdate,r=Me.needsUpdate,i=Me.type;Be(),Ce.autoReset=e,Me.enabled=t,Me.autoUpdate=n,Me.needsUpdate=r,Me.type=i}function We(e){G(`WebGLRenderer: A WebGL context could not be created. Reason: `,e.statusMessage)}function Ge(e){let t=e.target;t.removeEventListener(`dispose`,Ge),Ke(t)}function Ke(e){qe(e),V.remove(e)}function qe(e){let t=V.get(e).programs;t!==void 0&&(t.forEach(function(e){U.releaseProgram(e)}),e.isShaderMaterial&&U.releaseShaderCache(e))}this.renderBufferDirect=function(e,t,n,r,i,a){t===null&&(t=_e);let o=i.isMesh&&i.matrixWorld.determinantAffine()<0,s=ut(e,t,n,r,i);B.setMaterial(r,o);let c=n.index,l=1;if(r.wireframe===!0){if(c=Ee.getWireframeAttribute(n),c===void 0)return;l=2}let u=n.drawRange,d=n.attributes.position,f=u.start*l,p=(u.start+u.count)*l;a!==null&&(f=Math.max(f,a.start*l),p=Math.min(p,(a.start+a.count)*l)),c===null?d!=null&&(f=Math.max(f,0),p=Math.min(p,d.count)):(f=Math.max(f,0),p=Math.min(p,c.count));let m=p-f;if(m<0||m===1/0)return;Re.setup(i,r,s,n,c);let h,g=Fe;if(c!==null&&(h=Te.get(c),g=Ie,g.setIndex(h)),i.isMesh)r.wireframe===!0?(B.setLineWidth(r.wireframeLinewidth*ye()),g.setMode(z.LINES)):g.setMode(z.TRIANGLES);else if(i.isLine){let e=r.linewidth;e===void 0&&(e=1),B.setLineWidth(e*ye()),i.isLineSegments?g.setMode(z.LINES):i.isLineLoop?g.setMode(z.LINE_LOOP):g.setMode(z.LINE_STRIP)}else i.isPoints?g.setMode(z.POINTS):i.isSprite&&g.setMode(z.TRIANGLES);if(i.isBatchedMesh){if(xe.get(`WEBGL_multi_draw`))g.renderMultiDraw(i._multiDrawStarts,i._multiDrawCounts,i._multiDrawCount);else{let e=i._multiDrawStarts,t=i._multiDrawCounts,n=i._multiDrawCount,a=c?Te.get(c).bytesPerElement:1,o=V.get(r).currentProgram.getUniforms();for(let r=0;r<n;r++)o.setValue(z,`_gl_DrawID`,r),g.render(e[r]/a,t[r])}}else if(i.isInstancedMesh)g.renderInstances(f,m,i.count);else if(n.isInstancedBufferGeometry){let e=n._maxInstanceCount===void 0?1/0:n._maxInstanceCount,t=Math.min(n.instanceCount,e);g.renderInstances(f,m,t)}else g.render(f,m)};function Je(e,t,n,r){D!==null&&e.isNodeMaterial&&D.setObject(r,e),fe===!0&&je.setState(e,n,!1),e.transparent===!0&&e.side===2&&e.forceSinglePass===!1?(e.side=1,e.needsUpdate=!0,ot(e,t,r),e.side=0,e.needsUpdate=!0,ot(e,t,r),e.side=2):ot(e,t,r)}this.compile=function(e,t,n=null){n===null&&(n=e),D!==null&&D.renderStart(e,t,n),x=Ae.get(n),x.init(t),C.push(x),n.traverseVisible(function(e){e.isLight&&e.layers.test(t.layers)&&(x.pushLight(e),e.castShadow&&x.pushShadow(e))}),e!==n&&e.traverseVisible(function(e){e.isLight&&e.layers.test(t.layers)&&(x.pushLight(e),e.castShadow&&x.pushShadow(e))}),x.setupLights(),D!==null&&D.updateLights(x.state.lightsArray),pe=this.localClippingEnabled,fe=je.init(this.clippingPlanes,pe),fe===!0&&je.setGlobalState(this.clippingPlanes,t),D!==null&&Me.render(x.state.shadowsArray,n,t);let r=new Set;return e.traverse(function(e){if(!(e.isMesh||e.isPoints||e.isLine||e.isSprite))return;let i=e.material;if(i){if(Array.isArray(i))for(let a=0;a<i.length;a++){let o=i[a];Je(o,n,t,e),r.add(o)}else Je(i,n,t,e),r.add(i)}}),x=C.pop(),D!==null&&D.renderEnd(),r},this.compileAsync=function(e,t,n=null){let r=this.compile(e,t,n);return new Promise(t=>{function n(){r.forEach(function(e){let t=V.get(e).currentProgram;(t===void 0||t.isReady())&&r.delete(e)}),r.size===0?t(e):setTimeout(n,10)}xe.get(`KHR_parallel_shader_compile`)===null?setTimeout(n,10):n()})};let Ye=null;function Xe(e){Ye&&Ye(e)}function Ze(){$e.stop()}function Qe(){$e.start()}let $e=new Ds;$e.setAnimationLoop(Xe),typeof self<`u`&&$e.setContext(self),this.setAnimationLoop=function(e){Ye=e,Ve.setAnimationLoop(e),e===null?$e.stop():$e.start()},Ve.addEventListener(`sessionstart`,Ze),Ve.addEventListener(`sessionend`,Qe),this.render=function(e,t){if(t!==void 0&&t.isCamera!==!0){G(`WebGLRenderer.render: camera is not an instance of THREE.Camera.`);return}if(E===!0)return;D!==null&&D.renderStart(e,t);let n=Ve.enabled===!0&&Ve.isPresenting===!0,r=w!==null&&(N===null||n)&&w.begin(T,N);if(e.matrixWorldAutoUpdate===!0&&e.updateMatrixWorld(),t.parent===null&&t.matrixWorldAutoUpdate===!0&&t.updateMatrixWorld(),Ve.enabled===!0&&Ve.isPresenting===!0&&(w===null||w.isCompositing()===!1)&&(Ve.cameraAutoUpdate===!0&&Ve.updateCamera(t),t=Ve.getCamera()),e.isScene===!0&&e.onBeforeRender(T,e,t,N),x=Ae.get(e,C.length),x.init(t),x.state.textureUnits=H.getTextureUnits(),C.push(x),me.multiplyMatrices(t.projectionMatrix,t.matrixWorldInverse),t.isArrayCamera?de.setFromArrayCamera(t):ue.setFromProjectionMatrix(me,Yn,t.reversedDepth),pe=this.localClippingEnabled,fe=je.init(this.clippingPlanes,pe),b=ke.get(e,S.length),b.init(),S.push(b),this.info.render.frame++,Ve.enabled===!0&&Ve.isPresenting===!0){let e=T.xr.getDepthSensingMesh();e!==null&&et(e,t,-1/0,T.sortObjects)}et(e,t,0,T.sortObjects),b.finish(),D!==null&&D.updateLights(x.state.lightsArray),T.sortObjects===!0&&b.sort(oe,R),ve=Ve.enabled===!1||Ve.isPresenting===!1||Ve.hasDepthSensing()===!1,ve&&Ne.addToRenderList(b,e),this.info.autoReset===!0&&this.info.reset(),fe===!0&&je.beginShadows();let i=x.state.shadowsArray;if(Me.render(i,e,t),fe===!0&&je.endShadows(),(r&&w.hasRenderPass())===!1){let n=b.opaque,r=b.transmissive;if(x.setupLights(),t.isArrayCamera){let i=t.cameras;if(r.length>0)for(let t=0,a=i.length;t<a;t++){let a=i[t];nt(n,r,e,a)}ve&&Ne.render(e);for(let t=0,n=i.length;t<n;t++){let n=i[t];tt(b,e,n,n.viewport)}}else r.length>0&&nt(n,r,e,t),ve&&Ne.render(e),tt(b,e,t)}N!==null&&M===0&&(H.updateMultisampleRenderTarget(N),H.updateRenderTargetMipmap(N)),r&&w.end(T),e.isScene===!0&&e.onAfterRender(T,e,t),Re.resetDefaultState(),P=-1,F=null,C.pop(),C.length>0?(x=C[C.length-1],H.setTextureUnits(x.state.textureUnits),fe===!0&&je.setGlobalState(T.clippingPlanes,x.state.camera)):x=null,S.pop(),b=S.length>0?S[S.length-1]:null,D!==null&&D.renderEnd()};function et(e,t,n,r){if(e.visible===!1)return;if(e.layers.test(t.layers)){if(e.isGroup)n=e.renderOrder;else if(e.isLOD)e.autoUpdate===!0&&e.update(t);else if(e.isLight)x.pushLight(e),e.castShadow&&x.pushShadow(e);else if(e.isSprite){let i=t.isArrayCamera?de:ue;if(!e.frustumCulled||e.intersectsFrustum(i)){r&&ge.setFromMatrixPosition(e.matrixWorld).applyMatrix4(me);let i=De.update(e),a=e.material;a.visible&&b.push(e,i,a,n,ge.z,null,t)}}else if(e.isMesh||e.isLine||e.isPoints){let i=t.isArrayCamera?de:ue;if(!e.frustumCulled||e.intersectsFrustum(i)){let i=De.update(e),a=e.material;if(r&&(e.boundingSphere===void 0?(i.boundingSphere===null&&i.computeBoundingSphere(),ge.copy(i.boundingSphere.center)):(e.boundingSphere===null&&e.computeBoundingSphere(),ge.copy(e.boundingSphere.center)),ge.applyMatrix4(e.matrixWorld).applyMatrix4(me)),Array.isArray(a)){let r=i.groups;for(let o=0,s=r.length;o<s;o++){let s=r[o],c=a[s.materialIndex];c&&c.visible&&b.push(e,i,c,n,ge.z,s,t)}}else a.visible&&b.push(e,i,a,n,ge.z,null,t)}}}let i=e.children;for(let e=0,a=i.length;e<a;e++)et(i[e],t,n,r)}function tt(e,t,n,r){let{opaque:i,transmissive:a,transparent:o}=e;x.setupLightsView(n),fe===!0&&je.setGlobalState(T.clippingPlanes,n),r&&B.viewport(I.copy(r)),i.length>0&&rt(i,t,n),a.length>0&&rt(a,t,n),o.length>0&&rt(o,t,n),B.buffers.depth.setTest(!0),B.buffers.depth.setMask(!0),B.buffers.color.setMask(!0),B.setPolygonOffset(!1)}function nt(e,t,n,r){if((n.isScene===!0?n.overrideMaterial:null)!==null)return;if(x.state.transmissionRenderTarget[r.id]===void 0){let e=xe.has(`EXT_color_buffer_half_float`)||xe.has(`EXT_color_buffer_float`);x.state.transmissionRenderTarget[r.id]=new Ir(1,1,{generateMipmaps:!0,type:e?Ft:Ot,minFilter:Dt,samples:Math.max(4,Se.samples),stencilBuffer:i,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:X.workingColorSpace})}let a=x.state.transmissionRenderTarget[r.id],o=r.viewport||I;a.setSize(o.z*T.transmissionResolutionScale,o.w*T.transmissionResolutionScale);let s=T.getRenderTarget(),c=T.getActiveCubeFace(),l=T.getActiveMipmapLevel();T.setRenderTarget(a),T.getClearColor(ne),re=T.getClearAlpha(),re<1&&T.setClearColor(16777215,.5),T.clear(),ve&&Ne.render(n);let u=T.toneMapping;T.toneMapping=0;let d=r.viewport;if(r.viewport!==void 0&&(r.viewport=void 0),x.setupLightsView(r),fe===!0&&je.setGlobalState(T.clippingPlanes,r),rt(e,n,r),H.updateMultisampleRenderTarget(a),H.updateRenderTargetMipmap(a),xe.has(`WEBGL_multisampled_render_to_texture`)===!1){let e=!1;for(let i=0,a=t.length;i<a;i++){let{object:a,geometry:o,material:s,group:c}=t[i];if(s.side===2&&a.layers.test(r.layers)){let t=s.side;s.side=1,s.needsUpdate=!0,it(a,n,r,o,s,c),s.side=t,s.needsUpdate=!0,e=!0}}e===!0&&(H.updateMultisampleRenderTarget(a),H.updateRenderTargetMipmap(a))}T.setRenderTarget(s,c,l),T.setClearColor(ne,re),d!==void 0&&(r.viewport=d),T.toneMapping=u}function rt(e,t,n){let r=t.isScene===!0?t.overrideMaterial:null;for(let i=0,a=e.length;i<a;i++){let a=e[i],{object:o,geometry:s,group:c}=a,l=a.material;l.allowOverride===!0&&r!==null&&(l=r),o.layers.test(n.layers)&&it(o,t,n,s,l,c)}}function it(e,t,n,r,i,a){D!==null&&i.isNodeMaterial&&D.setObject(e,i),e.onBeforeRender(T,t,n,r,i,a),e.modelViewMatrix.multiplyMatrices(n.matrixWorldInverse,e.matrixWorld),e.normalMatrix.getNormalMatrix(e.modelViewMatrix),i.onBeforeRender(T,t,n,r,e,a),i.transparent===!0&&i.side===2&&i.forceSinglePass===!1?(i.side=1,i.needsUpdate=!0,T.renderBufferDirect(n,t,r,i,e,a),i.side=0,i.needsUpdate=!0,T.renderBufferDirect(n,t,r,i,e,a),i.side=2):T.renderBufferDirect(n,t,r,i,e,a),e.onAfterRender(T,t,n,r,i,a)}function at(e){let t=0;for(let n of e)n.texture!==null&&t++;return t}function ot(e,t,n){t.isScene!==!0&&(t=_e);let r=V.get(e),i=x.state.lights,a=x.state.shadowsArray,o=i.state.version,s=U.getParameters(e,i.state,a,t,n,x.state.lightProbeGridArray),c=U.getProgramCacheKey(s),l=r.programs;r.environment=e.isMeshStandardMaterial||e.isMeshLambertMaterial||e.isMeshPhongMaterial?t.environment:null,r.fog=t.fog;let u=e.isMeshStandardMaterial||e.isMeshLambertMaterial&&!e.envMap||e.isMeshPhongMaterial&&!e.envMap;r.envMap=we.get(e.envMap||r.environment,u),r.envMapRotation=r.environment!==null&&e.envMap===null?t.environmentRotation:e.envMapRotation,l===void 0&&(e.addEventListener(`dispose`,Ge),l=new Map,r.programs=l,r.programVariants=new Map);let d=l.get(c);if(d!==void 0){if(r.currentProgram===d&&r.lightsStateVersion===o)return lt(e,s),d}else s.uniforms=U.getUniforms(e),D!==null&&e.isNodeMaterial&&D.build(e,n,s),e.onBeforeCompile(s,T),d=U.acquireProgram(s,c),l.set(c,d),r.uniforms=s.uniforms;let f=r.uniforms;return(!e.isShaderMaterial&&!e.isRawShaderMaterial||e.clipping===!0)&&(f.clippingPlanes=je.uniform),lt(e,s),r.needsLights=ft(e),r.lightsStateVersion=o,r.needsLights&&(f.ambientLightColor.value=i.state.ambient,f.lightProbe.value=i.state.probe,f.sunLights.value=i.state.sun,f.sunLightShadows.value=i.state.sunShadow,f.directionalLights.value=i.state.directional,f.directionalLightShadows.value=i.state.directionalShadow,f.spotLights.value=i.state.spot,f.spotLightShadows.value=i.state.spotShadow,f.rectAreaLights.value=i.state.rectArea,f.ltc_1.value=i.state.rectAreaLTC1,f.ltc_2.value=i.state.rectAreaLTC2,f.pointLights.value=i.state.point,f.pointLightShadows.value=i.state.pointShadow,f.hemisphereLights.value=i.state.hemi,f.sunShadowMatrix.value=i.state.sunShadowMatrix,f.sunShadowCascade.value=i.state.sunShadowCascade,f.directionalShadowMatrix.value=i.state.directionalShadowMatrix,f.spotLightMatrix.value=i.state.spotLightMatrix,f.spotLightMap.value=i.state.spotLightMap,f.pointShadowMatrix.value=i.state.pointShadowMatrix),r.numLightProbeGrids=at(x.state.lightProbeGridArray),r.currentProgram=d,r.uniformsList=null,d}function st(e,t,n,r,i){let a=V.get(e),o=a.currentProgram.id+`,`+r+`,`+i,s=a.programVariants.get(o);return s===void 0?(s=ot(e,t,n),a.programVariants.set(o,s)):(a.currentProgram=s,a.uniformsList=null,a.outputColorSpace=r,a.toneMapping=i),s}function ct(e){if(e.uniformsList===null){let t=e.currentProgram.getUniforms();e.uniformsList=vl.seqWithValue(t.seq,e.uniforms)}return e.uniformsList}function lt(e,t){let n=V.get(e);n.outputColorSpace=t.outputColorSpace,n.batching=t.batching,n.batchingColor=t.batchingColor,n.instancing=t.instancing,n.instancingColor=t.instancingColor,n.instancingMorph=t.instancingMorph,n.skinning=t.skinning,n.morphTargets=t.morphTargets,n.morphNormals=t.morphNormals,n.morphColors=t.morphColors,n.morphTargetsCount=t.morphTargetsCount,n.numClippingPlanes=t.numClippingPlanes,n.numIntersection=t.numClipIntersection,n.vertexAlphas=t.vertexAlphas,n.vertexTangents=t.vertexTangents,n.toneMapping=t.toneMapping}function ut(e,t,n,r,i){t.isScene!==!0&&(t=_e),H.resetTextureUnits();let a=t.fog,o=r.isMeshStandardMaterial||r.isMeshLambertMaterial||r.isMeshPhongMaterial?t.environment:null,s=N===null?T.outputColorSpace:N.isXRRenderTarget===!0?N.texture.colorSpace:X.workingColorSpace,c=r.isMeshStandardMaterial||r.isMeshLambertMaterial&&!r.envMap||r.isMeshPhongMaterial&&!r.envMap,l=we.get(r.envMap||o,c),u=r.vertexColors===!0&&!!n.attributes.color&&n.attributes.color.itemSize===4,d=!!n.attributes.tangent&&(!!r.normalMap||r.anisotropy>0),f=!!n.morphAttributes.position,p=!!n.morphAttributes.normal,m=!!n.morphAttributes.color,h=0;r.toneMapped&&(N===null||N.isXRRenderTarget===!0)&&(h=T.toneMapping);let g=n.morphAttributes.position||n.morphAttributes.normal||n.morphAttributes.color,_=g===void 0?0:g.length,v=V.get(r),b=x.state.lights;if(fe===!0&&(pe===!0||e!==F)){let t=e===F&&r.id===P;je.setState(r,e,t)}let S=!1,C=!1;r.version===v.__version?v.needsLights&&v.lightsStateVersion!==b.state.version||i.isBatchedMesh&&v.batching===!1||!i.isBatchedMesh&&v.batching===!0||i.isBatchedMesh&&v.batchingColor===!0&&i._colorsTexture===null||i.isBatchedMesh&&v.batchingColor===!1&&i._colorsTexture!==null||i.isInstancedMesh&&v.instancing===!1||!i.isInstancedMesh&&v.instancing===!0||i.isSkinnedMesh&&v.skinning===!1||!i.isSkinnedMesh&&v.skinning===!0||i.isInstancedMesh&&v.instancingColor===!0&&i.instanceColor===null||i.isInstancedMesh&&v.instancingColor===!1&&i.instanceColor!==null||i.isInstancedMesh&&v.instancingMorph===!0&&i.morphTexture===null||i.isInstancedMesh&&v.instancingMorph===!1&&i.morphTexture!==null?S=!0:v.envMap===l?r.fog===!0&&v.fog!==a||v.numClippingPlanes!==void 0&&(v.numClippingPlanes!==je.numPlanes||v.numIntersection!==je.numIntersection)?S=!0:v.vertexAlphas===u&&v.vertexTangents===d&&v.morphTargets===f&&v.morphNormals===p&&v.morphColors===m&&v.morphTargetsCount===_&&v.numLightProbeGrids===at(x.state.lightProbeGridArray)?(v.outputColorSpace!==s||v.toneMapping!==h)&&(C=!0):S=!0:S=!0:(S=!0,v.__version=r.version);let w=v.currentProgram;(S===!0||C===!0)&&(w=C===!0?st(r,t,i,s,h):ot(r,t,i),D&&r.isNodeMaterial&&D.onUpdateProgram(r,w,v));let E=!1,O=!1,k=!1,A=w.getUniforms(),j=v.uniforms;if(B.useProgram(w.program)&&(E=!0,O=!0,k=!0),r.id!==P&&(P=r.id,O=!0),E||F!==e){B.buffers.depth.getReversed()&&e.reversedDepth!==!0&&(e._reversedDepth=!0,e.updateProjectionMatrix()),A.setValue(z,`projectionMatrix`,e.projectionMatrix),A.setValue(z,`viewMatrix`,e.matrixWorldInverse);let t=A.map.cameraPosition;t!==void 0&&t.setValue(z,he.setFromMatrixPosition(e.matrixWorld)),Se.logarithmicDepthBuffer&&A.setValue(z,`logDepthBufFC`,2/(Math.log(e.far+1)/Math.LN2)),(r.isMeshPhongMaterial||r.isMeshToonMaterial||r.isMeshLambertMaterial||r.isMeshBasicMaterial||r.isMeshStandardMaterial||r.isShaderMaterial)&&A.setValue(z,`isOrthographic`,e.isOrthographicCamera===!0),F!==e&&(F=e,O=!0,k=!0)}if(v.needsLights&&(b.state.sunShadowMap.length>0&&A.setValue(z,`sunShadowMap`,b.state.sunShadowMap,H),b.state.directionalShadowMap.length>0&&A.setValue(z,`directionalShadowMap`,b.state.directionalShadowMap,H),b.state.spotShadowMap.length>0&&A.setValue(z,`spotShadowMap`,b.state.spotShadowMap,H),b.state.pointShadowMap.length>0&&A.setValue(z,`pointShadowMap`,b.state.pointShadowMap,H)),i.isSkinnedMesh){A.setOptional(z,i,`bindMatrix`),A.setOptional(z,i,`bindMatrixInverse`);let e=i.skeleton;e&&(e.boneTexture===null&&e.computeBoneTexture(),A.setValue(z,`boneTexture`,e.boneTexture,H))}i.isBatchedMesh&&(A.setOptional(z,i,`batchingTexture`),A.setValue(z,`batchingTexture`,i._matricesTexture,H),A.setOptional(z,i,`batchingIdTexture`),A.setValue(z,`batchingIdTexture`,i._indirectTexture,H),A.setOptional(z,i,`batchingColorTexture`),i._colorsTexture!==null&&A.setValue(z,`batchingColorTexture`,i._colorsTexture,H));let M=n.morphAttributes;if((M.position!==void 0||M.normal!==void 0||M.color!==void 0)&&Pe.update(i,n,w),(O||v.receiveShadow!==i.receiveShadow)&&(v.receiveShadow=i.receiveShadow,A.setValue(z,`receiveShadow`,i.receiveShadow)),(r.isMeshStandardMaterial||r.isMeshLambertMaterial||r.isMeshPhongMaterial)&&r.envMap===null&&t.environment!==null&&(j.envMapIntensity.value=t.environmentIntensity),j.dfgLUT!==void 0&&(j.dfgLUT.value=Fu()),O){if(A.setValue(z,`toneMappingExposure`,T.toneMappingExposure),v.needsLights&&dt(j,k),a&&r.fog===!0&&Oe.refreshFogUniforms(j,a),Oe.refreshMaterialUniforms(j,r,L,ae,x.state.transmissionRenderTarget[e.id]),v.needsLights&&v.numLightProbeGrids>0){let e=y,t=0;for(let n of x.state.lightProbeGridArray)n.texture!==null&&(e.textures[t]=n.texture,e.min[t]=n.boundingBox.min,e.max[t]=n.boundingBox.max,e.resolution[t]=n.resolution,t++);for(let n in e)e[n].length=t;j.probesSH.value=e.textures,j.probesMin.value=e.min,j.probesMax.value=e.max,j.probesResolution.value=e.resolution}vl.upload(z,ct(v),j,H)}if(r.isShaderMaterial&&r.uniformsNeedUpdate===!0&&(vl.upload(z,ct(v),j,H),r.uniformsNeedUpdate=!1),r.isSpriteMaterial&&A.setValue(z,`center`,i.center),A.setValue(z,`modelViewMatrix`,i.modelViewMatrix),A.setValue(z,`normalMatrix`,i.normalMatrix),A.setValue(z,`modelMatrix`,i.matrixWorld),r.uniformsGroups!==void 0){let e=r.uniformsGroups;for(let t=0,n=e.length;t<n;t++){let n=e[t];ze.update(n,w),ze.bind(n,w)}}return w}function dt(e,t){e.ambientLightColor.needsUpdate=t,e.lightProbe.needsUpdate=t,e.sunLights.needsUpdate=t,e.sunLightShadows.needsUpdate=t,e.directionalLights.needsUpdate=t,e.directionalLightShadows.needsUpdate=t,e.pointLights.needsUpdate=t,e.pointLightShadows.needsUpdate=t,e.spotLights.needsUpdate=t,e.spotLightShadows.needsUpdate=t,e.rectAreaLights.needsUpdate=t,e.hemisphereLights.needsUpdate=t}function ft(e){return e.isMeshLambertMaterial||e.isMeshToonMaterial||e.isMeshPhongMaterial||e.isMeshStandardMaterial||e.isShadowMaterial||e.isShaderMaterial&&e.lights===!0}this.getActiveCubeFace=function(){return j},this.getActiveMipmapLevel=function(){return M},this.getRenderTarget=function(){return N},this.setRenderTargetTextures=function(e,t,n){let r=V.get(e);r.__autoAllocateDepthBuffer=e.resolveDepthBuffer===!1,r.__autoAllocateDepthBuffer===!1&&(r.__useRenderToTexture=!1),V.get(e.texture).__webglTexture=t,V.get(e.depthTexture).__webglTexture=r.__autoAllocateDepthBuffer?void 0:n,r.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(e,t){let n=V.get(e);n.__webglFramebuffer=t,n.__useDefaultFramebuffer=t===void 0},this.setRenderTarget=function(e,t=0,n=0){N=e,j=t,M=n;let r=null,i=!1,a=!1;if(e){let o=V.get(e);if(o.__useDefaultFramebuffer!==void 0){B.bindFramebuffer(z.FRAMEBUFFER,o.__webglFramebuffer),I.copy(e.viewport),ee.copy(e.scissor),te=e.scissorTest,B.viewport(I),B.scissor(ee),B.setScissorTest(te),P=-1;return}if(o.__webglFramebuffer===void 0)H.setupRenderTarget(e);else if(o.__hasExternalTextures)H.rebindTextures(e,V.get(e.texture).__webglTexture,V.get(e.depthTexture).__webglTexture);else if(e.depthBuffer){let t=e.depthTexture;if(o.__boundDepthTexture!==t){if(t!==null&&V.has(t)&&(e.width!==t.image.width||e.height!==t.image.height))throw Error(`THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.`);H.setupDepthRenderbuffer(e)}}let s=e.texture;(s.isData3DTexture||s.isDataArrayTexture||s.isCompressedArrayTexture)&&(a=!0);let c=V.get(e).__webglFramebuffer;e.isWebGLCubeRenderTarget?(r=Array.isArray(c[t])?c[t][n]:c[t],i=!0):r=e.samples>0&&H.useMultisampledRTT(e)===!1?V.get(e).__webglMultisampledFramebuffer:Array.isArray(c)?c[n]:c,I.copy(e.viewport),ee.copy(e.scissor),te=e.scissorTest}else I.copy(se).multiplyScalar(L).floor(),ee.copy(ce).multiplyScalar(L).floor(),te=le;if(n!==0&&(r=O),B.bindFramebuffer(z.FRAMEBUFFER,r)&&B.drawBuffers(e,r),B.viewport(I),B.scissor(ee),B.setScissorTest(te),i){let r=V.get(e.texture);z.framebufferTexture2D(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_CUBE_MAP_POSITIVE_X+t,r.__webglTexture,n)}else if(a){let r=t;for(let t=0;t<e.textures.length;t++){let i=V.get(e.textures[t]);z.framebufferTextureLayer(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0+t,i.__webglTexture,n,r)}}else if(e!==null&&n!==0){let t=V.get(e.texture);z.framebufferTexture2D(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,t.__webglTexture,n)}P=-1};function pt(e){let t=V.get(e);return(t.__readFormat!==e.format||t.__readType!==e.type)&&(t.__readFormat=e.format,t.__readType=e.type,t.__formatReadable=Se.textureFormatReadable(e.format),t.__typeReadable=Se.textureTypeReadable(e.type)),t}this.readRenderTargetPixels=function(e,t,n,r,i,a,o,s=0){if(!(e&&e.isWebGLRenderTarget)){G(`WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.`);return}let c=V.get(e).__webglFramebuffer;if(e.isWebGLCubeRenderTarget&&o!==void 0&&(c=c[o],Array.isArray(c)&&(c=c[0])),c){B.bindFramebuffer(z.FRAMEBUFFER,c);try{let o=e.textures[s],c=o.format,l=o.type;e.textures.length>1&&z.readBuffer(z.COLOR_ATTACHMENT0+s);let u=pt(o);if(u.__formatReadable===!1){G(`WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.`);return}if(u.__typeReadable===!1){G(`WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.`);return}t>=0&&t<=e.width-r&&n>=0&&n<=e.height-i&&z.readPixels(t,n,r,i,Le.convert(c),Le.convert(l),a)}finally{let e=N===null?null:V.get(N).__webglFramebuffer;B.bindFramebuffer(z.FRAMEBUFFER,e)}}},this.readRenderTargetPixelsAsync=async function(e,t,n,r,i,a,o,s=0){if(!(e&&e.isWebGLRenderTarget))throw Error(`THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.`);let c=V.get(e).__webglFramebuffer;if(e.isWebGLCubeRenderTarget&&o!==void 0&&(c=c[o],Array.isArray(c)&&(c=c[0])),c){if(t>=0&&t<=e.width-r&&n>=0&&n<=e.height-i){B.bindFramebuffer(z.FRAMEBUFFER,c);let o=e.textures[s],l=o.format,u=o.type;e.textures.length>1&&z.readBuffer(z.COLOR_ATTACHMENT0+s);let d=pt(o);if(d.__formatReadable===!1)throw Error(`THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.`);if(d.__typeReadable===!1)throw Error(`THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.`);let f=z.createBuffer();z.bindBuffer(z.PIXEL_PACK_BUFFER,f),z.bufferData(z.PIXEL_PACK_BUFFER,a.byteLength,z.STREAM_READ),z.readPixels(t,n,r,i,Le.convert(l),Le.convert(u),0),z.bindBuffer(z.PIXEL_PACK_BUFFER,null);let p=N===null?null:V.get(N).__webglFramebuffer;B.bindFramebuffer(z.FRAMEBUFFER,p);let m=z.fenceSync(z.SYNC_GPU_COMMANDS_COMPLETE,0);return z.flush(),await ir(z,m,4),z.bindBuffer(z.PIXEL_PACK_BUFFER,f),z.getBufferSubData(z.PIXEL_PACK_BUFFER,0,a),z.bindBuffer(z.PIXEL_PACK_BUFFER,null),z.deleteBuffer(f),z.deleteSync(m),a}throw Error(`THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.`)}},this.copyFramebufferToTexture=function(e,t=null,n=0){let r=2**-n,i=Math.floor(e.image.width*r),a=Math.floor(e.image.height*r),o=t===null?0:t.x,s=t===null?0:t.y;H.setTexture2D(e,0),z.copyTexSubImage2D(z.TEXTURE_2D,n,0,0,o,s,i,a),B.unbindTexture()},this.copyTextureToTexture=function(e,t,n=null,r=null,i=0,a=0){let o,s,c,l,u,d,f,p,m,h=e.isCompressedTexture?e.mipmaps[a]:e.image;if(n!==null)o=n.max.x-n.min.x,s=n.max.y-n.min.y,c=n.isBox3?n.max.z-n.min.z:1,l=n.min.x,u=n.min.y,d=n.isBox3?n.min.z:0;else{let t=2**-i;o=Math.floor(h.width*t),s=Math.floor(h.height*t),c=e.isDataArrayTexture?h.depth:e.isData3DTexture?Math.floor(h.depth*t):1,l=0,u=0,d=0}r===null?(f=0,p=0,m=0):(f=r.x,p=r.y,m=r.z);let g=Le.convert(t.format),_=Le.convert(t.type),v;t.isData3DTexture?(H.setTexture3D(t,0),v=z.TEXTURE_3D):t.isDataArrayTexture||t.isCompressedArrayTexture?(H.setTexture2DArray(t,0),v=z.TEXTURE_2D_ARRAY):(H.setTexture2D(t,0),v=z.TEXTURE_2D),B.activeTexture(z.TEXTURE0),B.pixelStorei(z.UNPACK_FLIP_Y_WEBGL,t.flipY),B.pixelStorei(z.UNPACK_PREMULTIPLY_ALPHA_WEBGL,t.premultiplyAlpha),B.pixelStorei(z.UNPACK_ALIGNMENT,t.unpackAlignment);let y=B.getParameter(z.UNPACK_ROW_LENGTH),b=B.getParameter(z.UNPACK_IMAGE_HEIGHT),x=B.getParameter(z.UNPACK_SKIP_PIXELS),S=B.getParameter(z.UNPACK_SKIP_ROWS),C=B.getParameter(z.UNPACK_SKIP_IMAGES);B.pixelStorei(z.UNPACK_ROW_LENGTH,h.width),B.pixelStorei(z.UNPACK_IMAGE_HEIGHT,h.height),B.pixelStorei(z.UNPACK_SKIP_PIXELS,l),B.pixelStorei(z.UNPACK_SKIP_ROWS,u),B.pixelStorei(z.UNPACK_SKIP_IMAGES,d);let w=e.isDataArrayTexture||e.isData3DTexture,T=t.isDataArrayTexture||t.isData3DTexture;if(e.isDepthTexture){let n=V.get(e),r=V.get(t),h=V.get(n.__renderTarget),g=V.get(r.__renderTarget);B.bindFramebuffer(z.READ_FRAMEBUFFER,h.__webglFramebuffer),B.bindFramebuffer(z.DRAW_FRAMEBUFFER,g.__webglFramebuffer);for(let n=0;n<c;n++)w&&(z.framebufferTextureLayer(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,V.get(e).__webglTexture,i,d+n),z.framebufferTextureLayer(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,V.get(t).__webglTexture,a,m+n)),z.blitFramebuffer(l,u,l+o,u+s,f,p,f+o,p+s,z.DEPTH_BUFFER_BIT,z.NEAREST);B.bindFramebuffer(z.READ_FRAMEBUFFER,null),B.bindFramebuffer(z.DRAW_FRAMEBUFFER,null)}else if(i!==0||e.isRenderTargetTexture||V.has(e)){let n=V.get(e),r=V.get(t);B.bindFramebuffer(z.READ_FRAMEBUFFER,k),B.bindFramebuffer(z.DRAW_FRAMEBUFFER,A);for(let e=0;e<c;e++)w?z.framebufferTextureLayer(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,n.__webglTexture,i,d+e):z.framebufferTexture2D(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,n.__webglTexture,i),T?z.framebufferTextureLayer(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,r.__webglTexture,a,m+e):z.framebufferTexture2D(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,r.__webglTexture,a),i===0?T?z.copyTexSubImage3D(v,a,f,p,m+e,l,u,o,s):z.copyTexSubImage2D(v,a,f,p,l,u,o,s):z.blitFramebuffer(l,u,l+o,u+s,f,p,f+o,p+s,z.COLOR_BUFFER_BIT,z.NEAREST);B.bindFramebuffer(z.READ_FRAMEBUFFER,null),B.bindFramebuffer(z.DRAW_FRAMEBUFFER,null)}else T?e.isDataTexture||e.isData3DTexture?z.texSubImage3D(v,a,f,p,m,o,s,c,g,_,h.data):t.isCompressedArrayTexture?z.compressedTexSubImage3D(v,a,f,p,m,o,s,c,g,h.data):z.texSubImage3D(v,a,f,p,m,o,s,c,g,_,h):e.isDataTexture?z.texSubImage2D(z.TEXTURE_2D,a,f,p,o,s,g,_,h.data):e.isCompressedTexture?z.compressedTexSubImage2D(z.TEXTURE_2D,a,f,p,h.width,h.height,g,h.data):z.texSubImage2D(z.TEXTURE_2D,a,f,p,o,s,g,_,h);B.pixelStorei(z.UNPACK_ROW_LENGTH,y),B.pixelStorei(z.UNPACK_IMAGE_HEIGHT,b),B.pixelStorei(z.UNPACK_SKIP_PIXELS,x),B.pixelStorei(z.UNPACK_SKIP_ROWS,S),B.pixelStorei(z.UNPACK_SKIP_IMAGES,C),a===0&&t.generateMipmaps===!0&&t.mipmapsAutoUpdate===!0&&z.generateMipmap(v),B.unbindTexture()},this.initRenderTarget=function(e){V.get(e).__webglFramebuffer===void 0&&H.setupRenderTarget(e)},this.initTexture=function(e){e.isCubeTexture?H.setTextureCube(e,0):e.isData3DTexture?H.setTexture3D(e,0):e.isDataArrayTexture||e.isCompressedArrayTexture?H.setTexture2DArray(e,0):H.setTexture2D(e,0),B.unbindTexture()},this.resetState=function(){j=0,M=0,N=null,B.reset(),Re.reset()},typeof __THREE_DEVTOOLS__<`u`&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent(`observe`,{detail:this}))}get coordinateSystem(){return Yn}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(e){this._outputColorSpace=e;let t=this.getContext();t.drawingBufferColorSpace=X._getDrawingBufferColorSpace(e),t.unpackColorSpace=X._getUnpackColorSpace()}};function Lu(e,t){let n=document.createElement(`canvas`);n.width=e.width,n.height=e.height;let r=n.getContext(`2d`);return r.drawImage(e,0,0),t&&!t.hidden&&zu(r,e,t),new Promise((e,t)=>{n.toBlob(n=>n?e(n):t(Error(`The picture could not be created.`)),`image/png`)})}function Ru(e,t,n){let r=e.getBoundingClientRect(),i=t.getBoundingClientRect(),a=n.height/r.height,o=document.createElement(`canvas`);o.width=Math.max(1,Math.ceil((i.width+2)*a)),o.height=Math.max(1,Math.ceil((i.height+2)*a));let s=o.getContext(`2d`);Bu(s,{left:i.left-1,top:i.top-1},a,t);let c=r.right-i.right,l=i.left-r.left,u=l<=c?(l-1)*a:n.width-o.width-(c-1)*a,d=(i.top-1-r.top)*a;return{image:s.getImageData(0,0,o.width,o.height),x:Math.round(u),y:Math.round(d)}}function zu(e,t,n){let r=t.getBoundingClientRect();Bu(e,r,t.width/r.width,n)}function Bu(e,t,n,r){e.scale(n,n);let i=e=>{let n=e.getBoundingClientRect();return{x:n.left-t.left,y:n.top-t.top,width:n.width,height:n.height}},a=i(r),o=getComputedStyle(r);e.fillStyle=o.backgroundColor,e.strokeStyle=o.borderTopColor,e.fillRect(a.x,a.y,a.width,a.height),e.strokeRect(a.x,a.y,a.width,a.height);for(let t of r.querySelectorAll(`canvas`)){let n=i(t);n.width>0&&e.drawImage(t,n.x,n.y,n.width,n.height)}e.textBaseline=`middle`;for(let t of r.querySelectorAll(`span, li, i`)){let n=i(t),r=getComputedStyle(t);if(n.width===0)continue;if(t.tagName===`I`){e.fillStyle=r.backgroundColor,e.fillRect(n.x,n.y,n.width,n.height);continue}e.fillStyle=r.color,e.font=r.font;let a=t.querySelector(`i`)?16:0;e.fillText(t.textContent??``,n.x+a,n.y+n.height/2,Math.max(1,n.width-a))}}var Vu={front:[0,0,1],back:[0,0,-1],right:[1,0,0],left:[-1,0,0],top:[0,1,0],bottom:[0,-1,0]},Hu=30,Uu=.92,Wu=.5;function Gu(e){let t=e,n=(e,t)=>Array.isArray(e)&&e.length===t&&e.every(e=>Number.isFinite(e));return typeof t==`object`&&!!t&&n(t.quaternion,4)&&n(t.pivot,3)&&t.distance>0&&Number.isFinite(t.distance)&&(t.up===`y`||t.up===`z`)}var Ku=class e{three=new ss(Hu,1,.01,100);pivot=new J;clip=null;distance=1;trackball=!1;isFlat=!1;outline=null;up=`y`;center=new J;radius=1;closest=.001;company=null;reach=0;width=1;height=1;setBounds(e,t,n=0){this.closest=Math.max(Wu*n,.001*(t||1)),this.reach=0,this.company=null,this.center.set(e[0],e[1],e[2]),this.radius=t||1}setCompany(e){this.company=e,this.update()}get wholeRadius(){let{company:e}=this;if(!e)return this.radius;let t=this.center.distanceTo(new J(...e.center));return Math.max(this.radius,t+e.radius)}resize(e,t){this.width=Math.max(1,e),this.height=Math.max(1,t),this.three.aspect=this.width/this.height,this.update()}copy({width:t,height:n}){let r=new e;r.setBounds(this.center.toArray(),this.radius),r.closest=this.closest,r.restore(this.state),r.reach=this.reach;let i=Math.min(1,t/n/this.three.aspect),a=Math.tan(Hu*Math.PI/360)/i;return r.three.fov=360/Math.PI*Math.atan(a),r.resize(t,n),r}upVector(){return this.up===`y`?new J(0,1,0):new J(0,0,1)}toward(){return this.three.getWorldDirection(new J).negate().toArray()}right(){return new J(1,0,0).applyQuaternion(this.three.quaternion).toArray()}upward(){return new J(0,1,0).applyQuaternion(this.three.quaternion).toArray()}frame(){this.pivot.copy(this.center);let e=Math.tan(Hu*Math.PI/360);this.distance=(this.company?0:this.outlineDistance(Uu*e*this.three.aspect,Uu*e))||this.wholeRadius/Math.sin(Math.atan(e*Math.min(1,this.three.aspect))),this.update()}outlineDistance(e,t){let[n,r,i]=[this.right(),this.upward(),this.toward()],a=this.center.toArray(),o=(e,t,n,r)=>e[0]*t+e[1]*n+e[2]*r,s=0,c=this.outline??[];for(let l=0;l<c.length;l+=3){let[u,d,f]=[c[l]-a[0],c[l+1]-a[1],c[l+2]-a[2]],p=Math.max(Math.abs(o(n,u,d,f))/e,Math.abs(o(r,u,d,f))/t),m=o(i,u,d,f);s=Math.max(s,m+Math.max(p,m))}return s}look(e){if(this.isFlat)return;let t=new J(...Vu[e]);this.up===`z`&&t.set(t.x,-t.z,t.y),this.lookFrom(t)}lookFrom(e){let t=this.upVector();Math.abs(e.clone().normalize().dot(t))>.999&&t.set(0,this.up===`y`?0:1,this.up===`y`?-1:0);let n=new zr().lookAt(e,new J,t);this.three.quaternion.setFromRotationMatrix(n),this.update()}start(){let e=this.isFlat?new J(0,0,1):new J(.45,.28,1);this.up===`z`&&!this.isFlat&&e.set(e.x,-e.z,e.y),this.lookFrom(e),this.frame()}get state(){let{pivot:e,distance:t,up:n,trackball:r}=this;return{quaternion:this.three.quaternion.toArray(),pivot:e.toArray(),distance:t,up:n,trackball:r}}restore(e){this.up=e.up,this.trackball=e.trackball===!0,this.three.quaternion.fromArray(e.quaternion).normalize(),this.pivot.fromArray(e.pivot),this.distance=Math.min(this.radius*50,Math.max(this.closest,e.distance)),this.update()}level(){this.lookFrom(new J(0,0,1).applyQuaternion(this.three.quaternion))}setReach(e){e!==this.reach&&(this.reach=e,this.update())}pointInPlane(e,t,n){let{origin:r,direction:i}=this.ray(t,n),a=this.toward(),o=e=>e.reduce((e,t,n)=>e+t*a[n],0),s=o(e.map((e,t)=>e-r[t]))/o(i);return i.map((e,t)=>r[t]+s*e)}turn(e,t){if(this.isFlat){this.pan(e,t);return}let n=this.three.quaternion,r=Math.PI/Math.min(this.width,this.height),i=new _r().setFromAxisAngle(new J(1,0,0),-t*r);if(this.trackball){let t=new _r().setFromAxisAngle(new J(0,1,0),-e*r);n.multiply(t).multiply(i)}else{let t=this.upVector(),a=new _r().setFromAxisAngle(t,-e*r).multiply(n.clone().multiply(i)),o=new J(0,1,0).applyQuaternion(a).dot(t);o>.01||o>new J(0,1,0).applyQuaternion(n).dot(t)?n.copy(a):n.premultiply(new _r().setFromAxisAngle(t,-e*r))}n.normalize(),this.update()}roll(e){this.trackball&&!this.isFlat&&(this.three.quaternion.multiply(new _r().setFromAxisAngle(new J(0,0,1),e)),this.update())}get pixel(){return 2*this.distance*Math.tan(Hu*Math.PI/360)/this.height}pan(e,t){let n=new J(-e,t,0).multiplyScalar(this.pixel).applyQuaternion(this.three.quaternion);this.pivot.add(n),this.update()}zoom(e,t,n){let r=Math.min(this.radius*50,Math.max(this.closest,this.distance*e)),i=r/this.distance,a=new J((t-this.width/2)*this.pixel,(this.height/2-n)*this.pixel,0).applyQuaternion(this.three.quaternion).multiplyScalar(1-i);this.pivot.add(a),this.distance=r,this.update()}focusDepth(e){let t=this.three.getWorldDirection(new J),n=this.three.position,r=t.x*(e[0]-n.x)+t.y*(e[1]-n.y)+t.z*(e[2]-n.z);r>this.three.near&&(this.distance=r,this.pivot.copy(n).addScaledVector(t,r),this.update())}setPivot(e){this.pivot.set(e[0],e[1],e[2]),this.update()}update(){let e=new J(0,0,this.distance).applyQuaternion(this.three.quaternion);this.three.position.copy(this.pivot).add(e);let t=this.three.position.distanceTo(this.center),{wholeRadius:n,reach:r}=this;this.three.near=Math.max(t-2*n-r,this.distance*.01,n*1e-4),this.three.far=t+3*n+r,this.three.updateProjectionMatrix(),this.three.updateMatrixWorld()}ray(e,t){let n=new J(2*e/this.width-1,1-2*t/this.height,.5).unproject(this.three),r=this.three.position,i=n.sub(r).normalize();return{origin:[r.x,r.y,r.z],direction:[i.x,i.y,i.z],pixel:this.pixel/this.distance,clip:this.clip}}project(e){let t=new J(e[0],e[1],e[2]),n=t.clone().sub(this.three.position).dot(this.three.getWorldDirection(new J));return t.project(this.three),{x:(t.x+1)/2*this.width,y:(1-t.y)/2*this.height,scale:this.height/(2*n*Math.tan(Hu*Math.PI/360))}}},qu=`adwave-views`,Ju=[`las`,`laz`,`e57`,`pcd`,`gifti`,`freesurfer`,`cifti`,`mgh`];function Yu(e){return`${e.name} ${e.n_vertices}`}function Xu(){try{let e=JSON.parse(localStorage.getItem(qu)??`[]`);return Array.isArray(e)?e:[]}catch{return[]}}function Zu(e,t){let n=Xu().filter(([t])=>t!==Yu(e));try{localStorage.setItem(qu,JSON.stringify([...n.slice(-39),[Yu(e),t]]))}catch{}}function Qu(e){let t=Xu().find(([t])=>t===Yu(e))?.[1];return t&&Gu(t.camera)?t:null}function $u(e){let t=e.format?.toLowerCase()??``;return Ju.some(e=>t.startsWith(e))?`z`:`y`}function ed(e,t){let n=Qu(t);n?e.restore(n.camera):(e.trackball=!1,e.up=$u(t),e.start())}function td(e){try{let t=JSON.parse(e);return t&&Gu(t.camera)?t:null}catch{return null}}var nd=2e4,rd={size:{width:4e3,height:3e3},transparent:!0,legend:!0,frames:72,seconds:6};function id(e,t){let{name:n,n_vertices:r}=e.shape;return{picture:1,shape:{name:n,n_vertices:r},...t,view:e.shownView.get(),levels:e.doc.levels.choice,edit:b(e.doc,0)}}function ad(e){try{let t=JSON.parse(e),{width:n,height:r}=t.size,i=[n,r].every(e=>Number.isInteger(e)&&e>=16&&e<=2e4),a=t.frames>=1&&t.frames<=720&&t.seconds>0,o=td(JSON.stringify(t.view))!==null,s=Array.isArray(t.edit.layers)&&typeof t.levels==`object`;return t.picture===1&&i&&a&&o&&s?t:null}catch{return null}}async function od(t,n){let r=t.shape;if(n.shape.n_vertices!==r.n_vertices)throw Error(e.otherPicture(n.shape.name,n.shape.n_vertices,r.n_vertices));JSON.stringify(n.levels)!==JSON.stringify(t.doc.levels.choice)&&await t.session.setLevels(n.levels);let{revision:i,...a}=b(t.doc,0),{revision:o,...s}=n.edit;JSON.stringify(a)!==JSON.stringify(s)&&t.session.applyEdit(n.edit),await t.display.waitUntilSettled(),t.shownView?.set(n.view)}var sd=Uint32Array.from({length:256},(e,t)=>{let n=t;for(let e=0;e<8;e++)n=n&1?3988292384^n>>>1:n>>>1;return n});function cd(e,t=0){let n=~t;for(let t of e)n=sd[(n^t)&255]^n>>>8;return~n>>>0}var ld=[137,80,78,71,13,10,26,10],ud=1,dd=2,fd=class{width;height;parts;packed;done;above;constructor(e,t){this.width=e,this.height=t;let n=new DataView(new ArrayBuffer(13));n.setUint32(0,e),n.setUint32(4,t),n.setUint8(8,8),n.setUint8(9,6),this.parts=[new Uint8Array(ld),...pd(`IHDR`,new Uint8Array(n.buffer))],this.above=new Uint8Array(4*e);let{writable:r,readable:i}=new CompressionStream(`deflate`);this.packed=r.getWriter(),this.done=this.collect(i.getReader())}async collect(e){for(;;){let{done:t,value:n}=await e.read();if(t)return;this.parts.push(...pd(`IDAT`,n))}}async write(e){let t=4*this.width,n=e.length/t,r=new Uint8Array(n*(t+1));for(let i=0;i<n;i++){let n=e.subarray(i*t,(i+1)*t);this.filter(n,r.subarray(i*(t+1),(i+1)*(t+1))),this.above.set(n)}await this.packed.write(r)}filter(e,t){let{above:n}=this,[r,i]=[0,0];for(let t=0;t<e.length;t++)r+=Math.abs(e[t]-(t<4?0:e[t-4])<<24>>24),i+=Math.abs(e[t]-n[t]<<24>>24);let a=i<=r;t[0]=a?dd:ud;for(let r=0;r<e.length;r++)t[r+1]=e[r]-(a?n[r]:r<4?0:e[r-4])}async finish(){return await this.packed.close(),await this.done,new Blob([...this.parts,...pd(`IEND`,new Uint8Array)],{type:`image/png`})}async abort(){this.done.catch(()=>{}),await this.packed.abort().catch(()=>{})}};function pd(e,t){let n=new TextEncoder().encode(e),r=new DataView(new ArrayBuffer(4));r.setUint32(0,t.length);let i=new DataView(new ArrayBuffer(4));return i.setUint32(0,cd(t,cd(n))),[new Uint8Array(r.buffer),n,t,new Uint8Array(i.buffer)]}var md=1024,hd=34,gd=4096;async function _d(e,t){let{size:n,layers:r,signal:i}=t,a=new fd(n.width,n.height),o=2*n.height/e.part.height,s=Math.ceil(hd*o),c=Math.max(64,Math.min(md,Math.floor((gd-2*s)/2)));try{for(let l=0;l<n.height;l+=c){let u=Math.min(c,n.height-l),d=new Uint8Array(4*n.width*u);for(let r=0;r<n.width;r+=c){i.throwIfAborted();let a=Math.min(c,n.width-r);vd(e.drawSamples({camera:t.camera,whole:{width:2*n.width,height:2*n.height},part:{x:2*r,y:2*l,width:2*a,height:2*u},margin:s,scale:o,ground:t.ground}),{width:a,height:u},d.subarray(4*r),4*n.width),await new Promise(e=>setTimeout(e))}for(let e of r)yd(e,d,{top:l,width:n.width,height:u});await a.write(d),t.progress((l+u)/n.height)}return await a.finish()}catch(e){throw await a.abort(),e}}function vd(e,{width:t,height:n},r,i){let a=8*t,o=2*n;for(let s=0;s<n;s++)for(let n=0;n<t;n++){let[t,c,l,u]=[0,0,0,0];for(let r=0;r<2;r++){let i=(o-1-(2*s+r))*a+8*n;for(let n=0;n<2;n++,i+=4)t+=e[i],c+=e[i+1],l+=e[i+2],u+=e[i+3]}if(u===0)continue;let d=s*i+4*n;r[d]=Math.min(255,Math.round(255*t/u)),r[d+1]=Math.min(255,Math.round(255*c/u)),r[d+2]=Math.min(255,Math.round(255*l/u)),r[d+3]=Math.round(u/4)}}function yd({image:e,x:t,y:n},r,{top:i,width:a,height:o}){for(let s=Math.max(0,n-i);s<Math.min(o,n+e.height-i);s++)for(let o=Math.max(0,-t);o<Math.min(e.width,a-t);o++){let c=4*((s+i-n)*e.width+o),l=e.data[c+3]/255;if(l===0)continue;let u=4*(s*a+t+o),d=r[u+3]/255*(1-l),f=l+d;for(let t=0;t<3;t++)r[u+t]=Math.round((e.data[c+t]*l+r[u+t]*d)/f);r[u+3]=Math.round(255*f)}}var bd=[`video/webm;codecs=vp9`,`video/webm;codecs=vp8`,`video/webm`];function xd(){return typeof MediaRecorder>`u`?null:bd.find(e=>MediaRecorder.isTypeSupported(e))??null}async function Sd(e,t,n,r){let i=await createImageBitmap(e[0]),a=document.createElement(`canvas`);a.width=i.width,a.height=i.height;let o=a.getContext(`2d`,{alpha:!1});o.drawImage(i,0,0);let s=a.captureStream(0),c=s.getVideoTracks()[0],l=.8*a.width*a.height*e.length/t,u=new MediaRecorder(s,{mimeType:n,videoBitsPerSecond:Math.max(2e6,Math.min(6e7,l))}),d=[];u.addEventListener(`dataavailable`,({data:e})=>d.push(e));let f=new Promise((e,t)=>{u.addEventListener(`stop`,()=>e()),u.addEventListener(`error`,()=>t(Error(`The browser could not make the video.`)))});u.start();let p=performance.now();try{for(let[n,i]of e.entries()){r.throwIfAborted();let a=await createImageBitmap(i),s=p+1e3*n*t/e.length-performance.now();s>0&&await new Promise(e=>setTimeout(e,s)),o.drawImage(a,0,0),a.close(),c.requestFrame()}await new Promise(n=>setTimeout(n,1e3*t/e.length))}finally{u.state!==`inactive`&&u.stop();for(let e of s.getTracks())e.stop()}return await f,new Blob(d,{type:n})}var Cd=2**32-1,wd=20,Td=2048,Ed=33,Dd=class{parts=[];entries=[];size=0;async add(e,t){let n={name:new TextEncoder().encode(e),check:cd(new Uint8Array(await t.arrayBuffer())),size:t.size,at:this.size},r=kd([67324752,4],...Od(n),[0,2]),i=this.size+r.length+n.name.length+t.size;if(i>Cd)throw Error(`The archive must be below 4 GB. Choose fewer frames or a smaller size.`);this.parts.push(r,n.name,t),this.entries.push(n),this.size=i}finish(){let e=this.entries.flatMap(e=>[kd([33639248,4],[wd,2],...Od(e),[0,2],[0,2],[0,2],[0,2],[0,4],[e.at,4]),e.name]),t=e.reduce((e,t)=>e+t.length,0),n=this.entries.length,r=kd([101010256,4],[0,2],[0,2],[n,2],[n,2],[t,4],[this.size,4],[0,2]);return new Blob([...this.parts,...e,r],{type:`application/zip`})}};function Od({name:e,check:t,size:n}){return[[wd,2],[Td,2],[0,2],[0,2],[Ed,2],[t,4],[n,4],[n,4],[e.length,2]]}function kd(...e){let t=new DataView(new ArrayBuffer(e.reduce((e,[,t])=>e+t,0))),n=0;for(let[r,i]of e)i===2?t.setUint16(n,r,!0):t.setUint32(n,r,!0),n+=i;return new Uint8Array(t.buffer)}var Ad=3840,jd=class{studio;files;choices=rd;constructor(e,t){this.studio=e,this.files=t}async openRecipe(t,n){let r=ad(t);if(!r||!this.studio.shape||this.studio.isGrid)throw Error(e.badPicture(n));await od(this.studio,r);let{size:i,transparent:a,legend:o,frames:s,seconds:c}=r;this.choices={size:i,transparent:a,legend:o,frames:s,seconds:c},this.open()}open(){let{studio:t}=this,r=t.isGrid,i=Nd(e.pictureWidth,this.choices.size.width,16,nd),a=Nd(e.pictureHeight,this.choices.size.height,16,nd),o=Nd(e.turnFrames,this.choices.frames,1,720),s=Nd(e.turnSeconds,this.choices.seconds,1,120),{transparent:c,legend:u}=this.choices,d=n(`p`,{class:`problem`,role:`alert`,hidden:!0}),f=t=>()=>{let n=[i,a,...r?[]:[o,s]].find(({input:e})=>!e.checkValidity()||!Number.isInteger(e.valueAsNumber));if(d.hidden=!n,n){let{min:t,max:r,value:i}=n.input;d.textContent=e.pictureNumber(n.label,t,r,i),n.input.focus();return}let l={width:i.input.valueAsNumber,height:a.input.valueAsNumber};this.choices=r?{...this.choices,size:l,transparent:c}:{size:l,transparent:c,legend:u,frames:o.input.valueAsNumber,seconds:s.input.valueAsNumber},g.close(),this.files.reportErrors(()=>t(this.choices))},p=l(e.transparent,c,e=>{c=e}),m=l(e.withLegend,u,e=>{u=e}),h=f(e=>this.savePicture(e)),g=at(e.pictures,n(`p`,{},r?e.gridPicturesNote:e.picturesNote),n(`div`,{class:`row numbers`},i.element,r?null:a.element),p,r?null:m,d,n(`div`,{class:`row`},Pd(e.pictureSave,h,`primary`)),...r?[]:[n(`h3`,{},e.turntable),n(`div`,{class:`row numbers`},o.element,s.element),n(`div`,{class:`row`},Pd(e.framesSave,f(e=>this.saveFrames(e))),xd()?Pd(e.videoSave,f(e=>this.saveVideo(e))):n(`span`,{class:`hint`},e.noVideo)),n(`h3`,{},e.pictureRecipe),n(`p`,{},e.pictureRecipeNote),n(`div`,{class:`row`},Pd(e.pictureRecipeSave,f(e=>this.saveRecipe(e))))])}async prepare(){let{studio:e}=this;e.view.showRing(null,null),e.view.showMark(null),await e.display.waitUntilSettled()}paramsOf(e){let{view:t}=this.studio,{size:n}=e,r=e.legend?document.querySelector(`.legend`):null,i=r&&!r.hidden?Ru(t.canvas,r,n):null;return{size:n,ground:e.transparent?null:t.paper,layers:i?[i]:[]}}async savePicture(t){let{studio:n}=this,r=`${this.files.stem}-${t.size.width}.png`,i=await n.wait(e.drawing(0),async(r,i)=>n.isGrid?n.gridView.picture(t.size.width,t.transparent):(await this.prepare(),_d(n.view,{...this.paramsOf(t),camera:n.view.camera.copy(t.size),signal:r,progress:t=>i(e.drawing(t))})));i&&u(i,r)}async drawTurn(t,{signal:n,tell:r},i){await this.prepare();let{view:a}=this.studio,o=this.paramsOf(t);for(let s=0;s<t.frames;s++){let c=Md(a.camera.copy(t.size),s/t.frames);await i(await _d(a,{...o,camera:c,signal:n,progress:()=>{}}),s),r(e.drawingTurn(s+1,t.frames))}}async saveFrames(t){let{studio:n}=this,r=String(t.frames-1).length,i=await n.wait(e.drawingTurn(0,t.frames),async(e,n)=>{let i=new Dd;return await this.drawTurn(t,{signal:e,tell:n},(e,t)=>i.add(`${this.files.stem}-${String(t).padStart(r,`0`)}.png`,e)),i.finish()});i&&u(i,`${this.files.stem}-turn.zip`)}async saveVideo(t){let{studio:n}=this,r=Math.min(1,Ad/Math.max(t.size.width,t.size.height)),i=e=>Math.max(2,2*Math.round(e*r/2)),a={width:i(t.size.width),height:i(t.size.height)},o=await n.wait(e.drawingTurn(0,t.frames),async(n,r)=>{let i=[];return await this.drawTurn({...t,size:a,transparent:!1},{signal:n,tell:r},async e=>{i.push(e)}),r(e.encoding(t.seconds)),Sd(i,t.seconds,xd(),n)});o&&u(o,`${this.files.stem}-turn.webm`)}async saveRecipe(e){let t=JSON.stringify(id(this.studio,e),null,1);u(new Blob([t],{type:`application/json`}),`${this.files.stem}.picture.json`)}};function Md(e,t){let n=e.up===`y`?new J(0,1,0):new J(0,0,1);return e.three.quaternion.premultiply(new _r().setFromAxisAngle(n,-2*Math.PI*t)),e.update(),e}function Nd(e,t,r,i){let a=n(`input`,{type:`number`,min:String(r),max:String(i),step:`1`,required:!0,value:String(t),"aria-label":e});return{label:e,input:a,element:n(`label`,{class:`field`},n(`span`,{},e),a)}}function Pd(e,t,r=``){return n(`button`,{type:`button`,class:r,onclick:t},e)}function Fd(e,t){return n(`button`,{type:`button`,onclick:t},e)}function Id(t,r,i){let a=t.shape,o=n(`input`,{type:`number`,min:`0.1`,max:`10`,step:`0.1`,value:`1`,"aria-label":e.strength}),s=(e,n)=>{i(),r.reportErrors(async()=>{await t.saver?.waitUntilSent(),await t.wait(`${e}…`,e=>n(()=>e.aborted))})},c=n=>s(e.compare,e=>Rd(t,n,e)),l=[...t.beside.section(i),n(`h3`,{},e.compare),n(`p`,{},e.compareNote),n(`div`,{class:`row`},Fd(e.compareMethods.taubin,()=>c(`taubin`)),Fd(e.compareMethods.harmonics,()=>c(`harmonics`)),t.comparison?Fd(e.compareEnd,()=>{zd(t),i()}):null)],u=[n(`h3`,{},e.report),n(`p`,{},e.reportNote),n(`div`,{class:`row`},Fd(e.reportGo,()=>s(e.report,async r=>{let{path:i}=await t.api.report(a.id);if(r())return;let o=new URL(i,t.api.root).href;at(e.report,n(`p`,{},e.reportReady),n(`p`,{},n(`a`,{href:o,target:`_blank`,rel:`noopener`,class:`primary`},e.reportOpen)))})))],d=[n(`h3`,{},e.denoise),n(`p`,{},e.denoiseNote),n(`div`,{class:`row`},n(`label`,{class:`field`},n(`span`,{},e.strength),o),Fd(e.denoiseGo,()=>s(e.denoise,async n=>{let i=(await t.engine.call(`positions`,{})).positions,s=await t.api.denoise(a.id,o.valueAsNumber||1);n()?await t.api.close(s.id):(await r.refreshShapes(),await r.showShape(s.id),await Ld(t,s.id,a,i),t.showMessage(e.denoised(s.noise)))})))],f=a.kind===`curve`;return(a.graph?[...u,...f?d:[]]:[...l,...u,...d]).filter(e=>e!==null)}async function Ld(e,t,n,r){if(e.shape?.id!==t)return;let{center:i}=e.shape;for(let e=0;e<r.length;e++)r[e]+=n.center[e%3]-i[e%3];let{normals:a}=await e.engine.call(`normals`,{positions:r.slice()});e.view.arrays.setComparison(r,a),e.comparison={method:`noisy`,about:null},e.emit(`compared`)}async function Rd(e,t,n){let{id:r}=e.shape,{positions:i,about:a}=await e.api.compare(r,t);if(e.shape?.id!==r||n())return;let{normals:o}=await e.engine.call(`normals`,{positions:i});e.view.arrays.setComparison(i,o),e.comparison={method:t,about:a},e.emit(`compared`)}function zd(e){e.view.arrays.setComparison(null,null),e.comparison=null,e.emit(`compared`)}function Bd(t){let r=n(`aside`,{class:`comparison`,hidden:!0,"aria-label":e.compare});return t.on(`compared`,()=>{let{comparison:i}=t;if(r.hidden=i===null,!i)return;let{about:a,method:o}=i;if(!a){r.replaceChildren(n(`p`,{class:`hint`},e.noisyHint),Fd(e.compareEnd,()=>zd(t)));return}let s=(e,t,r)=>n(`tr`,{},n(`th`,{scope:`row`},e),n(`td`,{},t),n(`td`,{},r));r.replaceChildren(n(`table`,{},n(`thead`,{},n(`tr`,{},n(`td`,{}),n(`th`,{scope:`col`},e.thisEdit),n(`th`,{scope:`col`},e.compareShort[o]))),n(`tbody`,{},s(e.roughness,H(a.roughness.edit),H(a.roughness.other)),s(e.rms,H(a.rms.edit),H(a.rms.other)))),n(`p`,{class:`hint`},Vd(a)),Fd(e.compareEnd,()=>zd(t)))}),r}function Vd({how:t}){return`degree`in t?e.howTaubin(t.degree,H(t.frequency)):e.howHarmonics(t.harmonics,H(t.t))}function Hd(e,t,n){let r=e.length/3,{area:i,low:a}=Ud(e,t),o=Math.sqrt(3.4*i/n)||1,s=65536;for(;s<4*n;)s<<=1;let c=new Int32Array(s).fill(-1),l=new Uint32Array(s),u=new Uint32Array(r);for(let t=0;t<r;t++){let n=Math.floor((e[3*t]-a[0])/o)&1023,r=Math.floor((e[3*t+1]-a[1])/o)&1023,i=(Math.floor((e[3*t+2]-a[2])/o)&1023)<<20|r<<10|n,d=Math.imul(i,2654435761)>>>8&s-1,f=0;for(;c[d]!==-1&&c[d]!==i&&f<64;)d=d+1&s-1,f++;c[d]===i?u[t]=l[d]:(u[t]=t,c[d]===-1&&(c[d]=i,l[d]=t))}let d=new Uint32Array(t.length),f=0;for(let e=0;e<t.length;e+=3){let n=u[t[e]],r=u[t[e+1]],i=u[t[e+2]];n!==r&&r!==i&&i!==n&&(d[f++]=n,d[f++]=r,d[f++]=i)}return d.slice(0,f)}function Ud(e,t){let n=[1/0,1/0,1/0];for(let t=0;t<e.length;t++)e[t]<n[t%3]&&(n[t%3]=e[t]);let r=0;for(let n=0;n<t.length;n+=3){let i=3*t[n],a=3*t[n+1],o=3*t[n+2],s=e[a]-e[i],c=e[a+1]-e[i+1],l=e[a+2]-e[i+2],u=e[o]-e[i],d=e[o+1]-e[i+1],f=e[o+2]-e[i+2],p=c*f-l*d,m=l*u-s*f,h=s*d-c*u;r+=Math.sqrt(p*p+m*m+h*h)}return{area:r/2,low:n}}function Wd(e,t){let n=new Float64Array(t).fill(1);for(let r of e)if(!r.mask)for(let e=0;e<t;e++)n[e]*=1+r.opacity*((r.gains[e]??1)-1);return n}function Gd(e,t){let n=0;for(let r=0;r<t.length;r+=3){let i=3*t[r],a=3*t[r+1],o=3*t[r+2],s=e[a],c=e[a+1],l=e[a+2],u=e[o],d=e[o+1],f=e[o+2];n+=e[i]*(c*f-l*d)+e[i+1]*(l*u-s*f)+e[i+2]*(s*d-c*u)}return n/6}function Kd(e,t,n){let r=e.filter(e=>!t.includes(e));return(n?[...r,...t]:r).sort((e,t)=>e-t)}function qd({inward:e},t){return(e??[]).map(e=>e.vertex).filter(e=>!t.includes(e))}function Jd(e,t,n){let r=new Set(n),i=new Uint32Array(e);for(let e=0;e<i.length;e+=3){if(!r.has(t[i[e]]))continue;let n=i[e+1];i[e+1]=i[e+2],i[e+2]=n}return i}var Yd=class{studio;triangles=new Uint32Array;nCoarse=0;partOfVertex=null;shown=[];turn=0;volumeBefore=null;constructor(e){this.studio=e}reset(e,t){this.turn++,this.triangles=e,this.nCoarse=t,this.partOfVertex=null,this.shown=[],this.volumeBefore=null,this.light()}get volume(){return this.volumeBefore??this.studio.shape?.volume??null}async partAt(e){let t=(await this.parts())[e];return t===void 0||t===4294967295?null:t}parts(){return this.partOfVertex??=this.studio.api.indices(`shapes/${this.studio.shape.id}/parts`),this.partOfVertex}set(e,t){let{doc:n,history:r}=this.studio;r.commit({...n,turned:Kd(n.turned,e,t)})}async show(){let{studio:e}=this,{turned:t}=e.doc;if(e.isGrid||!e.shape||Xd(t,this.shown))return;let n=++this.turn;this.shown=t;let{view:r,engine:i}=e,a=t.length?Jd(this.triangles,await this.parts(),t):new Uint32Array(this.triangles);if(n!==this.turn)return;let{originals:o}=r.arrays;this.volumeBefore=e.shape.volume===null?null:Gd(o,a);let{normals:s}=await i.call(`turn`,{triangles:a});if(n!==this.turn)return;let c=r.arrays.hasFew?Hd(o,a,this.nCoarse):null;r.arrays.setTriangles(a,c),r.arrays.setNormals(s),this.light(),e.display.settle(),e.emit(`turned`)}light(){let{shape:e,view:t}=this.studio;e&&(t.lit=qd(e,this.shown).length>0?`both`:`front`,t.request())}};function Xd(e,t){return e.length===t.length&&e.every((e,n)=>e===t[n])}var Zd=/\.(npy|dmat|mgh|mgz|annot|label|thickness|curv|sulc|area|shape\.gii|func\.gii|label\.gii|d(scalar|tseries|label)\.nii)(\.gz)?$/i,Qd=64<<20;async function $d(e,{n_vertices:t,graph:n}){if(!/\.(csv|tsv|txt)$/i.test(e.name)||e.size>Qd)return!1;let r=(await e.text()).split(`
`).filter(e=>e.trim()!==``),i=(r[0]??``).toLowerCase().split(/[\s,;]+/),a=i.some(e=>!/^([-+]?nan)?$/.test(e)&&Number.isNaN(Number(e)));return r.length===t+Number(a)?!!n||a&&!(i.includes(`x`)&&i.includes(`y`)):!1}var ef=class{studio;fetchShape;pictures;constructor(e,t){this.studio=e,this.fetchShape=t,this.pictures=new jd(e,this)}async showShape(e){try{let{domain:t}=this.studio.shapes.shapes.find(t=>t.id===e)??{domain:`shape`};await this.studio.session.open(this.fetchShape(this.studio.api,{id:e,domain:t}))}catch(e){this.studio.showMessage(e.message,`error`)}}async refreshShapes(){this.studio.shapes=await this.studio.api.shapes(),this.studio.emit(`shapes`)}async openFile(t){let{studio:n}=this;if(/\.toml$/i.test(t.name))await this.reportErrors(async()=>n.session.applyRecipe(await t.text()));else if(/\.edit\.json$/i.test(t.name))await this.reportErrors(async()=>n.session.applyEdit(JSON.parse(await t.text())));else if(/\.picture\.json$/i.test(t.name))await this.reportErrors(async()=>this.pictures.openRecipe(await t.text(),t.name));else if(/\.view\.json$/i.test(t.name)){let r=td(await t.text());r&&n.shape?n.shownView?.set(r):n.showMessage(e.badView(t.name),`error`)}else await this.reportErrors(async()=>{let{shape:e}=n;if(e&&!e.grid&&(Zd.test(t.name)||await $d(t,e))){await this.addFields(t);return}let r=await this.openShape(t);r&&(await this.refreshShapes(),await this.showShape(r.id))})}async openShape(n){let{studio:r}=this;try{return await r.wait(e.reading(n.name),e=>r.api.open(n,n.name,e))}catch(e){if(!r.shape||r.isGrid||!(e instanceof t)||e.status!==400)throw e;try{await this.addFields(n)}catch(t){throw/\.(gii|nii|csv|txt)(\.gz)?$/i.test(n.name)?t:e}return null}}async addFields(t){let{studio:n}=this,{id:r}=n.shape,i=await n.wait(e.reading(t.name),e=>n.api.addFields(r,t,t.name,e));if(!i||n.shape?.id!==r)return;let{fields:a}=await n.api.shape(r);n.shape={...n.shape,fields:a},n.emit(`fields`),n.showField(i.fields[0]),n.target!==null&&i.fields.includes(n.target)&&await n.loadTarget();let o=a.find(e=>e.name===i.fields[0]);o?.series?n.showMessage(e.seriesAdded(o.series.name,Ue(n.shape,o.name).length)):n.showMessage(e.fieldAdded(i.fields[0],o?.editable===!0))}async close(t){let{studio:n}=this;await this.reportErrors(async()=>{let r=n.shapes.shapes.find(e=>e.id!==t);r?(n.shape?.id===t&&await this.showShape(r.id),await n.api.close(t),await this.refreshShapes()):n.showMessage(e.lastShape)})}async reportErrors(n){try{await n()}catch(n){let r=n instanceof t?nf(n.body):null,i=r&&{label:e.readableFormats,onclick:()=>rf(r)};this.studio.showMessage(n.message,`error`,i??void 0)}}choose(){d(``,e=>void this.openFile(e))}async save(n=null,r=!1,i=null){let{studio:a}=this;if(!a.shape)return;let{shape:o}=a,{id:s}=o;await this.reportErrors(async()=>{try{await a.saver?.waitUntilSent();let{path:t,notes:c}=await a.api.save(s,n,r,i),l=qd(o,a.doc.turned).length;l>0&&c.push(e.savedInward(l,o.components)),a.showMessage([e.saved(t),...c].join(` `))}catch(r){if(!(r instanceof t)||!r.body?.exists)throw r;let o={label:e.replaceFile,onclick:()=>void this.save(n,!0,i)};a.showMessage(r.message,`error`,o)}})}get stem(){return af(this.studio.shape.name)}async quitStudio(){await this.reportErrors(async()=>{await this.studio.saver?.waitUntilSent(),await this.studio.api.endStudio(),document.getElementById(`app`).replaceChildren(n(`p`,{class:`fatal`,role:`status`},e.finished))})}saveEdit(){let e=JSON.stringify(b(this.studio.doc,0));u(new Blob([e],{type:`application/json`}),`${this.stem}.edit.json`)}async page(){let{studio:t}=this;t.showMessage(e.working),await this.reportErrors(async()=>{await t.saver?.waitUntilSent();let n=await t.api.page(t.shape.id);u(new Blob([n],{type:`text/html`}),`${this.stem}.html`),t.showMessage(e.pageMade((n.size/1e6).toFixed(1)))})}async picture(){await this.reportErrors(async()=>{let{view:e,isGrid:t,gridView:n}=this.studio;if(t){u(await n.picture(),`${this.stem}.png`);return}e.draw();let r=document.querySelector(`.legend`);u(await Lu(e.canvas,r),`${this.stem}.png`)})}openMenu(){let{shape:t}=this.studio;if(!t)return;let r=()=>o.close(),i=qd(t,this.studio.doc.turned).length,a=i>0?[e.inwardFile(i,t.components),...t.notes]:t.notes,o=at(e.file,...this.saveSection(r),...this.downloadSection(t,r),...this.fieldSection(t),...this.recipeSection(t,r),n(`div`,{class:`row narrow-only`},t.grid?null:tf(e.tools,()=>{r(),this.openTools()}),tf(e.theme,()=>this.studio.toggleTheme())),n(`h3`,{},e.quit),n(`p`,{},e.quitNote),n(`div`,{class:`row`},tf(e.quit,()=>{r(),this.askToQuit()})),a.length?n(`h3`,{},e.notes):null,a.length?n(`ul`,{},...a.map(e=>n(`li`,{},e))):null)}openTools(){if(!this.studio.shape)return;let t=at(e.tools,...Id(this.studio,this,()=>t.close()))}askToQuit(){let t=at(e.quit,n(`p`,{},e.quitQuestion),n(`div`,{class:`actions`},tf(e.quit,()=>{t.close(),this.quitStudio()},`primary`)))}numberType(){let{shape:t}=this.studio;if(!t?.grid)return null;let r=e.numberTypes[t.grid.value_type]??t.grid.value_type;return n(`select`,{"aria-label":e.numberType},n(`option`,{value:``},e.numbersOfFile(r)),n(`option`,{value:`f32`},e.numberTypes.f32))}saveSection(t){let r=n(`input`,{type:`text`,placeholder:e.saveNameHint,"aria-label":e.saveName}),i=!1,a=this.numberType();return[n(`h3`,{},e.save),n(`p`,{},e.saveNote),n(`div`,{class:`row`},r,a,tf(e.save,()=>{t(),this.save(r.value.trim()||null,i,a?.value||null)},`primary`)),l(e.saveReplace,!1,e=>{i=e})]}downloadSection(t,r){let{studio:i}=this,a=n(`select`,{"aria-label":e.format},...t.formats.map(t=>n(`option`,{value:t},e.formatName(t)))),o=t.formats.find(e=>e.toLowerCase()===t.format?.toLowerCase());o&&(a.value=o);let s=this.numberType();return[n(`h3`,{},e.downloads),n(`div`,{class:`row`},a,s,tf(e.download,()=>void this.reportErrors(async()=>{await i.saver?.waitUntilSent();let e=a.value.toLowerCase(),n=e===`gifti`?`gii`:e.replace(`-ascii`,``),r=t.grid?.extensions[e]??n;u(await i.api.download(t.id,e,s?.value||null),`${this.stem}-edited.${r}`)}))),n(`div`,{class:`row`},tf(e.picture,()=>void this.picture()),tf(e.picturesOpen,()=>{r(),this.pictures.open()}),...t.grid?[]:this.shapeDownloads(t,r)),t.grid||t.graph?null:n(`p`,{class:`hint`},e.pageNote)]}shapeDownloads(t,n){let{studio:r}=this;return[tf(e.viewFile,()=>{let e=JSON.stringify(r.shownView?.get());u(new Blob([e],{type:`application/json`}),`${this.stem}.view.json`)}),...t.graph?[]:[tf(e.pageGo,()=>{n(),this.page()})]]}fieldSection(t){let{studio:r}=this,i=r.shownField;if(i===null)return[];let a=n(`select`,{"aria-label":e.fieldFormat},...e.fieldFormats.map(([e,t])=>n(`option`,{value:e},t))),o=(e=>()=>void this.reportErrors(async()=>{await r.saver?.waitUntilSent(),await e()}))(async()=>{let e=a.value;u(await r.api.fieldFile(t.id,i,e),`${i}-edited.${e}`)});return[n(`h3`,{},e.fieldValues(i)),n(`div`,{class:`row`},a,tf(e.fieldDownload,o),tf(e.recipeOf(i),()=>this.downloadRecipe(t,i)))]}downloadRecipe(e,t){let{studio:n}=this;this.reportErrors(async()=>{await n.saver?.waitUntilSent();let r=await n.api.recipe(e.id,t);u(new Blob([r],{type:`application/toml`}),`${t??this.stem}.toml`)})}recipeSection(t,r){let{studio:i}=this,a=i.doc.fields.filter(e=>!L(e.layers)).map(e=>e.field),o=(P(i.doc)&&a.length>0?a:[null]).filter(e=>e===null||e!==i.shownField).map(n=>tf(n===null?e.recipeSave:e.recipeOf(n),()=>this.downloadRecipe(t,n))),s=()=>d(`.toml`,e=>{r(),this.reportErrors(async()=>i.session.applyRecipe(await e.text()))});return[n(`h3`,{},e.recipe),n(`p`,{},e.recipeNote),n(`div`,{class:`row`},...o,tf(e.recipeOpen,s))]}tabs(){let{studio:t}=this,r=n(`nav`,{class:`tabs`,"aria-label":e.shapes});return t.on([`shapes`,`shape`],()=>{r.replaceChildren(...t.shapes.shapes.map(r=>{let i=r.id===t.shape?.id;return n(`span`,{class:i?`tab here`:`tab`},n(`button`,{type:`button`,"aria-current":i?`page`:void 0,title:r.name,onclick:()=>void this.showShape(r.id)},r.name),t.shapes.shapes.length>1?a(`close`,e.closeShape(r.name),()=>void this.close(r.id)):null)}),a(`plus`,e.open,()=>this.choose()))}),r}acceptDrops(e){e.addEventListener(`dragover`,t=>{t.preventDefault(),e.classList.add(`dropping`)}),e.addEventListener(`dragleave`,t=>{t.relatedTarget||e.classList.remove(`dropping`)}),e.addEventListener(`drop`,t=>{t.preventDefault(),e.classList.remove(`dropping`);for(let e of t.dataTransfer?.files??[])this.openFile(e)})}};function tf(e,t,r=``){return n(`button`,{type:`button`,class:r,onclick:t},e)}function nf(e){let t=e?.readable_formats;return Array.isArray(t)?t:null}function rf(t){at(e.readableFormats,n(`ul`,{class:`formats`},...t.map(e=>n(`li`,{},e.title,` `,n(`small`,{},e.extensions.join(` `))))))}function af(e){return e.replace(/(\.gz)?$/i,``).replace(/\.[^.]*$/,``)||`shape`}var of=Math.cos(4*Math.PI/180);function sf(e,t){return e.reduce((e,n,r)=>e+n*t[r],0)}function cf(e,t,n){return e.map((e,r)=>e+n*t[r])}function lf(e){let t=Math.hypot(...e)||1;return e.map(e=>e/t)}function uf(e,t){return[e[1]*t[2]-e[2]*t[1],e[2]*t[0]-e[0]*t[2],e[0]*t[1]-e[1]*t[0]]}function df(e){let t=e.findIndex(e=>Math.abs(e)>of);return t<0?[...e]:[0,0,0].with(t,Math.sign(e[t]))}function ff(e,t,n,r){let i=e[t][n]+r,a=e[t===`min`?`max`:`min`][n],o=t===`min`?Math.min(i,a):Math.max(i,a);return{...e,[t]:e[t].with(n,o)}}function pf(e,t){return{...e,min:cf(e.min,t,1),max:cf(e.max,t,1)}}function mf(e,t){let n=(n,r,i)=>[n,r,i].map((n,r)=>n?t[r]:e[r]),r=e=>[n(0,0,e),n(1,0,e),n(1,1,e),n(0,1,e),n(0,0,e)],i=[0,1].flatMap(e=>[0,1].map(t=>[n(e,t,0),n(e,t,1)]));return[r(0),r(1),...i]}function hf(e,t,n){let r=t.reduce((e,n,r)=>Math.abs(n)<Math.abs(t[e])?r:e,0),i=lf(uf(t,[0,0,0].with(r,1))),a=uf(t,i),o=(t,r)=>cf(cf(e,i,t*n),a,r*n);return[o(-1,-1),o(1,-1),o(1,1),o(-1,1),o(-1,-1)]}var gf=.12,_f={half:.32,arrow:.22},vf=.01,yf={ArrowRight:[1,0],ArrowLeft:[-1,0],ArrowUp:[0,1],ArrowDown:[0,-1]},bf=4,xf=4,Sf={least:.005,most:.6},Cf=class{studio;stage;element;path;halo;buttons=[];outline=null;shown=null;isMasking=!1;maskAgain=!1;dragged=null;constructor(e,t){this.studio=e,this.stage=t;let r=`http://www.w3.org/2000/svg`,i=document.createElementNS(r,`svg`);this.halo=document.createElementNS(r,`path`),this.path=document.createElementNS(r,`path`),this.halo.setAttribute(`class`,`halo`),i.append(this.halo,this.path),i.setAttribute(`aria-hidden`,`true`),this.element=n(`div`,{class:`gizmo`,hidden:!0}),this.element.append(i),e.on([`doc`,`selected`,`tool`,`shape`,`target`,`drawing`,`tint`],()=>this.update()),e.view.afterFrame(()=>this.place())}get region(){let{studio:e}=this;if(!e.shape||e.isBrushOn||e.isGrabOn||!e.tint.region)return null;let{region:t}=e.layer;for(;t&&`not`in t;)t=t.not;return t&&(`ball`in t||`box`in t||`half-space`in t)?t:null}set(e){let{studio:t}=this,n=t=>t&&`not`in t?{not:n(t.not)}:e;t.changeLayer({region:n(t.layer.region)},!1),t.view.arrays.large&&this.showMask()}async showMask(){if(this.isMasking)this.maskAgain=!0;else{this.isMasking=!0;try{await this.studio.showMask(this.studio.layer,null)}catch(e){this.studio.showMessage(e.message,`error`)}this.isMasking=!1,this.maskAgain&&(this.maskAgain=!1,this.showMask())}}update(){let{region:e}=this;if(e===this.shown&&e!==null)return;this.shown=e,this.outline=e&&this.outlineOf(e);let t=this.outline?.handles??[];if(t.length!==this.buttons.length){for(let e of this.buttons)e.remove();this.buttons=t.map((e,t)=>this.handleButton(t)),this.element.append(...this.buttons)}for(let[e,{label:n}]of t.entries())this.buttons[e].setAttribute(`aria-label`,n),this.buttons[e].title=n;this.element.hidden=t.length===0,this.place()}place(){let{outline:e,studio:t}=this;if(!e)return;this.shown&&`ball`in this.shown&&(this.outline=this.outlineOf(this.shown));let{lines:n,circle:r,handles:i}=this.outline,{camera:a}=t.view,o=[...n.flat(),...i.map(e=>e.place)].every(e=>a.project(e).scale>0);if(this.element.classList.toggle(`behind`,!o),!o)return;let s=n.map(e=>`M${e.map(e=>{let{x:t,y:n}=a.project(e);return`${t.toFixed(1)} ${n.toFixed(1)}`}).join(`L`)}`);if(r){let{x:e,y:t,scale:n}=a.project(r.place),i=r.radius*n;s.push(`M${e-i} ${t}a${i} ${i} 0 1 0 ${2*i} 0a${i} ${i} 0 1 0 ${-2*i} 0`)}for(let e of[this.halo,this.path])e.setAttribute(`d`,s.join(``));for(let[e,t]of i.entries()){let{x:n,y:r}=a.project(t.place),i=this.buttons[e];i.style.transform=`translate(${n.toFixed(1)}px, ${r.toFixed(1)}px)`;let o=t.axis!==null&&this.slope(t.place,t.axis).length<gf;i.classList.toggle(`steep`,o&&this.dragged===null)}}slope(e,t){let{camera:n}=this.studio.view,r=.001*this.studio.shape.diagonal,i=n.project(e),a=n.project(cf(e,t,r)),[o,s]=[(a.x-i.x)/r,(a.y-i.y)/r];return{x:o,y:s,length:Math.hypot(o,s)/i.scale}}along(e,t,n,r){let{x:i,y:a}=this.slope(e,t);return((r.x-n.x)*i+(r.y-n.y)*a)/Math.max(1e-12,i*i+a*a)}outlineOf(e){return`box`in e?this.boxOutline(e.box):`half-space`in e?this.planeOutline(e[`half-space`]):`ball`in e?this.ballOutline(e):null}relative(e){return e.map((e,t)=>e-this.studio.shape.center[t])}boxOutline(t){let{camera:n}=this.studio.view,[r,i]=[this.relative(t.min),this.relative(t.max)],a=r.map((e,t)=>(e+i[t])/2),o=[0,1,2].flatMap(n=>[`min`,`max`].map(o=>{let s=a.with(n,o===`min`?r[n]:i[n]),c=[0,0,0].with(n,1),l=e=>({box:ff(t,o,n,e)});return{label:`${o===`min`?e.from:e.to} ${`xyz`[n]}`,place:s,axis:c,drag:(e,t)=>l(this.along(s,c,t,e)),step:([e,t])=>l(e+t)}})),s={label:e.moveRegion,place:a,axis:null,drag:(e,r)=>{let[i,o]=[r,e].map(({x:e,y:t})=>n.pointInPlane(a,e,t));return{box:pf(t,o.map((e,t)=>e-i[t]))}},step:e=>({box:pf(t,this.across(e))})};return{lines:mf(r,i),circle:null,handles:[s,...o]}}across([e,t]){let{camera:n}=this.studio.view;return cf(cf([0,0,0],n.right(),e),n.upward(),t)}planeOutline(t){let{diagonal:n,center:r}=this.studio.shape,{camera:i}=this.studio.view,a=lf(t.normal),o=cf([0,0,0],a,sf(this.relative(t.point),a)),s=cf(o,a,_f.arrow*n),c=e=>({"half-space":{...t,point:cf(t.point,a,e)}}),l=e=>{if(!(Math.hypot(...e)>.02*n))return null;let i=o.map((e,t)=>e+r[t]);return{"half-space":{...t,point:i,normal:df(lf(e))}}},u=[{label:e.movePlane,place:o,axis:a,drag:(e,t)=>c(this.along(o,a,t,e)),step:([e,t])=>c(e+t)},{label:e.turnPlane,place:s,axis:null,drag:({x:e,y:t})=>l(i.pointInPlane(s,e,t).map((e,t)=>e-o[t])),step:e=>{let t=s.map((e,t)=>e-o[t]);return l(cf(t,this.across(e),bf))}}];return{lines:[hf(o,a,_f.half*n),[o,s]],circle:null,handles:u}}ballOutline(t){let{ball:n}=t,{view:r,shape:i}=this.studio,{diagonal:a}=i,o=`vertex`in n.center?r.arrays.place(n.center.vertex):this.relative(n.center.point),s=V(n.radius,a),c=e=>{let t=Math.min(Sf.most*a,Math.max(Sf.least*a,e));return{ball:{...n,radius:Number(t.toPrecision(6))}}},l=[{label:e.moveCenterHandle,place:o,axis:null,drag:async({x:e,y:t})=>{let r=await this.stage.vertexAt(e,t);return r===null?null:{ball:{...n,center:{vertex:r}}}},step:e=>{let t=this.vertexBeside(o,e);return t===null?null:{ball:{...n,center:{vertex:t}}}}},{label:e.radius,place:cf(o,r.camera.right(),s),axis:null,drag:({x:e,y:t})=>c(Math.hypot(...r.camera.pointInPlane(o,e,t).map((e,t)=>e-o[t]))),step:([e,t])=>c(s+e+t)}];return{lines:[],circle:{place:o,radius:s},handles:l}}vertexBeside(e,t){let{arrays:n}=this.studio.view,r=n.nearest(e);for(let i=0;i<=xf;i++){let a=n.nearest(cf(e,this.across(t),2**i));if(a!==r)return a}return null}handleButton(e){let t=n(`button`,{type:`button`,class:`gizmo-handle`}),{studio:r}=this,i=e=>{let t=r.view.canvas.getBoundingClientRect();return{x:e.clientX-t.left,y:e.clientY-t.top}},a=null,o=null,s=!1,c=async(e,t)=>{if(!s){s=!0;try{for(;o;){let n=o;o=null;let r=await e.drag(n,t);r&&this.dragged===e&&this.set(r)}}catch(e){r.showMessage(e.message,`error`)}finally{s=!1}}};t.addEventListener(`pointerdown`,n=>{let r=this.outline?.handles[e];r&&n.button===0&&(n.preventDefault(),t.focus({preventScroll:!0}),t.setPointerCapture(n.pointerId),this.dragged=r,a=i(n),t.classList.add(`held`))}),t.addEventListener(`pointermove`,e=>{a&&this.dragged&&(o=i(e),c(this.dragged,a))});let l=async e=>{let n=this.dragged;if(a&&n){for(a=null,t.classList.remove(`held`);s;)await new Promise(e=>setTimeout(e));this.dragged===n&&(this.dragged=null,e.type===`pointerup`?r.history.end():r.history.cancel(),this.place())}};return t.addEventListener(`pointerup`,e=>void l(e)),t.addEventListener(`pointercancel`,e=>void l(e)),t.addEventListener(`keydown`,n=>{if(n.key===`Escape`&&this.dragged){n.stopPropagation(),this.dragged=null,a=null,t.classList.remove(`held`),r.history.cancel();return}let i=yf[n.key];if(!i)return;let o=vf*r.shape.diagonal,s=this.outline?.handles[e]?.step([o*i[0],o*i[1]]);s&&(n.preventDefault(),n.stopPropagation(),this.set(s),r.history.end())}),t}};function wf(e){let t=e.levels.every(e=>e.steps===2**(e.level-1));return e.fields.filter(e=>e.name!==`change`&&!e.rgb&&!e.channel&&(t||!/^band-\d+$/.test(e.name)))}function Tf(e){let t=wf(e);return t.find(e=>!e.edited&&!/^band-\d+$/.test(e.name))??t[0]}function Ef(e,t,n,r){let i=e=>V(e,r);switch(t){case`grow`:return`grown`in e?{grown:{by:i(e.grown.by)+n,region:e.grown.region}}:{grown:{by:n,region:e}};case`shrink`:return{not:Ef(`not`in e?e.not:{not:e},`grow`,n,r)};case`blur`:return`blurred`in e?{blurred:{by:Math.hypot(i(e.blurred.by),n),region:e.blurred.region}}:{blurred:{by:n,region:e}}}}var Df=1;function Of(t,n){let{region:r,key:i}=t.layer;if(!r||!t.shape){t.showMessage(e.reshapeNothing);return}let{diagonal:a}=t.shape;t.changeLayer({region:Ef(r,n,Df/100*a,a)},!0,i)}function kf(e){let t=e,n=!1;for(;t&&`not`in t;)t=t.not,n=!n;return{inner:t,inverted:n}}function Af(e){if(!e)return`everywhere`;let t=Object.keys(e)[0];return t===`vertices`||t===`painted`?`painted`:[`ball`,`stroke`,`box`,`half-space`,`component`,`field`].includes(t)?t:`other`}function jf({studio:e,shape:t},n){let{diagonal:r,center:i}=t,a=r/4;switch(n){case`painted`:return{painted:[]};case`ball`:return{ball:{center:{vertex:e.lastVertex??0},radius:.15*r}};case`box`:return{box:{min:i.map(e=>e-a),max:i.map(e=>e+a),falloff:.05*r}};case`half-space`:return{"half-space":{point:[...i],normal:[1,0,0],falloff:.1*r}};case`component`:return{component:{vertex:e.lastVertex??0}};case`field`:{let e=Tf(t)?.name;return e?{field:{name:e,low:0,high:1}}:null}default:return null}}function Mf({studio:e,set:t},n){return e.fieldRange(n).then(([e,r])=>t({field:{name:n,low:e,high:r}}),t=>{e.showMessage(t.message,`error`)})}function Nf({studio:t,set:n}){t.requestVertex(e.clickPart,e=>n({component:{vertex:e}}))}function Pf({shape:e,set:t},{label:n,value:r,max:i,toRegion:a}){let{diagonal:o}=e;return s(n,{min:.5,max:i,step:.5,value:Math.min(i,100*r/o)},e=>H(e/100*o),(e,n)=>{n&&t(a(e/100*o))})}function Ff({shape:e,set:t},{label:n,value:r,axis:i,toRegion:a}){let{diagonal:o}=e,c=e.center[i];return s(n,{min:-50,max:50,step:.5,value:100*(r-c)/o},e=>H(c+e/100*o),(e,n)=>{n&&t(a(c+e/100*o))})}function If(t,r){let{studio:i,shape:a,set:o}=t;return[n(`p`,{class:`hint`},`${e.ballHint} ${e.handlesHint}`),Pf(t,{label:e.radius,value:V(r.radius,a.diagonal),max:60,toRegion:e=>({ball:{...r,radius:e}})}),Gf(e.moveCenter,()=>{i.requestVertex(e.clickCenter,e=>o({ball:{...r,center:{vertex:e}}}))})]}function Lf(t,n){let{studio:r,shape:i,key:a}=t,o=V(n.radius,i.diagonal);return[Pf(t,{label:e.radius,value:o,max:30,toRegion:e=>({stroke:{...n,radius:e}})}),r.lineDrawing?Gf(e.lineEnd,()=>r.lineDrawing?.end()):Gf(e.lineAgain,()=>Kf(r,a,o))]}function Rf(t,r){let i=[0,1,2].flatMap(n=>[`min`,`max`].map(i=>Ff(t,{label:`${i===`min`?e.from:e.to} ${`xyz`[n]}`,value:r[i][n],axis:n,toRegion:e=>({box:{...r,[i]:r[i].with(n,e)}})}))),a=Pf(t,{label:e.falloff,value:V(r.falloff??`5%`,t.shape.diagonal),max:30,toRegion:e=>({box:{...r,falloff:e}})});return[n(`p`,{class:`hint`},e.handlesHint),...i,a]}function zf(t,r){let{shape:i,set:a}=t,o=Math.max(0,r.normal.findIndex(e=>e!==0)),s=r.normal.filter(e=>e!==0).length>1,l=s?`tilted`:`${(r.normal[o]??1)<0?`-`:`+`}${`xyz`[o]}`,u=[`+x`,`-x`,`+y`,`-y`,`+z`,`-z`].map(e=>[e,e.replace(`-`,`−`)]);return[n(`p`,{class:`hint`},e.handlesHint),c(e.toward,s?[...u,[`tilted`,e.tilted]]:u,l,e=>{if(e===`tilted`)return;let t=[0,0,0].with(`xyz`.indexOf(e[1]),e[0]===`-`?-1:1);a({"half-space":{...r,point:[...i.center],normal:t}})}),...s?[]:[Ff(t,{label:e.plane,value:r.point[o]??0,axis:o,toRegion:e=>({"half-space":{...r,point:r.point.with(o,e)}})})],Pf(t,{label:e.falloff,value:V(r.falloff??`5%`,i.diagonal),max:60,toRegion:e=>({"half-space":{...r,falloff:e}})})]}function Bf(t,r){let{shape:i,set:a}=t,o=(e,t)=>{let i=n(`input`,{type:`number`,step:`any`,value:String(Number(r[e].toPrecision(6))),onchange:()=>{Number.isFinite(i.valueAsNumber)&&a({field:{...r,[e]:i.valueAsNumber}})}});return n(`label`,{class:`field`},n(`span`,{},t),i)};return[c(e.field,wf(i).map(e=>[e.name,e.label]),r.name,e=>void Mf(t,e)),o(`low`,e.fieldLow),o(`high`,e.fieldHigh),Gf(e.fieldFit,()=>void Mf(t,r.name))]}function Vf(t,n){return n?`ball`in n?If(t,n.ball):`stroke`in n?Lf(t,n.stroke):`component`in n?[Gf(e.choosePart,()=>Nf(t))]:`box`in n?Rf(t,n.box):`half-space`in n?zf(t,n[`half-space`]):`field`in n?Bf(t,n.field):[]:[]}function Hf({studio:t,shape:r}){let i=(e,r,i)=>n(`button`,{type:`button`,title:r,onclick:()=>Of(t,i)},e);return[n(`div`,{class:`row reshape`,role:`group`,"aria-label":e.reshape},i(e.grow,e.growHint,`grow`),i(e.shrink,e.shrinkHint,`shrink`),i(e.blur,e.blurHint,`blur`)),s(e.reshapeBy,{min:.2,max:10,step:.2,value:Df},e=>H(e/100*r.diagonal),e=>{Df=e})]}function Uf(t,n,r){let{studio:i,shape:a,key:o,set:s}=t,l=e.regionChoices.filter(([e])=>e!==`other`||r===`other`).filter(([e])=>!a.graph?.placed||e!==`box`&&e!==`half-space`).map(([t,r])=>[t,t===`other`?e.otherRegion(qf(n)):r]);return c(e.where,l,r,e=>{if(e===`painted`&&i.setTool(`brush`),e===`stroke`){Kf(i,o,.04*a.diagonal);return}let n=jf(t,e);n&&`field`in n?Mf(t,n.field.name):(s(n),e===`component`&&Nf(t))})}function Wf(t){let{shape:r}=t;if(!r)return n(`div`);let{region:i,key:o}=t.layer,{inner:s,inverted:c}=kf(i),l={studio:t,shape:r,key:o,set:e=>t.changeLayer({region:c&&e?{not:e}:e},!0,o)},u=i?a(`invert`,e.invert,()=>t.changeLayer({region:c?s:{not:i}},!0,o),{"aria-pressed":String(c)}):null;return n(`div`,{class:`area`},n(`div`,{class:`row`},Uf(l,i,Af(s)),u),...Vf(l,s),...i?Hf(l):[])}function Gf(e,t){return n(`button`,{type:`button`,onclick:t},e)}function Kf(t,n,r){let i=[],a=e=>{t.lineDrawing=null,t.onPickVertex=null,e?t.history.end():t.history.cancel(),t.emit(`drawing`)},o=s=>{i.push({vertex:s}),t.lineDrawing={end:()=>a(!0),cancel:()=>a(!1)},t.changeLayer({region:{stroke:{path:[...i],radius:r}}},!1,n),t.requestVertex(e.lineClick,o)};t.requestVertex(e.lineClick,o)}function qf(t){if(!t)return e.everywhere;let n=Object.keys(t)[0];return`painted`in t?e.strokes(t.painted.length):`not`in t&&`grown`in t.not?e.shrunk:e.regionNames[n]??n}function Jf(t){let r=t?e.gridKeyList:e.keyList;at(e.keys,n(`dl`,{class:`keys`},...r.flatMap(([e,t])=>[n(`dt`,{},...e.split(` `).map(e=>n(`kbd`,{},e))),n(`dd`,{},t)])),n(`h3`,{},e.about),n(`p`,{},e.license),n(`p`,{},n(`a`,{href:`third-party-notices.txt`,target:`_blank`,rel:`noopener`},e.notices)))}function Yf(){document.querySelector(`.band input.gain:not(:disabled)`)?.focus()}function Xf(t,n,r,i){let{view:a}=t,o={1:[`front`,`back`],3:[`right`,`left`],7:[`top`,`bottom`]};window.addEventListener(`keydown`,s=>{let c=s.target instanceof HTMLElement?s.target:document.body,l=c.matches(`textarea, select, [contenteditable]`)||c instanceof HTMLInputElement&&c.type!==`range`&&c.type!==`checkbox`,u=s.ctrlKey||s.metaKey,d=s.key.length===1?s.key.toLowerCase():s.key;if(u&&!s.altKey){if(d===`z`&&!l)s.shiftKey?t.redo():t.undo();else if(d===`y`&&!l)t.redo();else if(d===`s`)i.save();else if(d===`o`)i.choose();else return;s.preventDefault();return}if(l||s.altKey||document.querySelector(`dialog[open]`))return;if(t.isGrid){if(d===`?`)Jf(!0);else if(d===`\\`)t.setBefore(!0);else if(d===`s`)t.gridView.toggleWipe();else if(d===`f`)t.gridView.fitAll();else if(d===`,`||d===`.`)t.gridView.frames.step(d===`.`?1:-1);else if(d===`e`)Yf();else return;s.preventDefault();return}let f=(s.code.match(/^(?:Digit|Numpad)([137])$/)??[])[1];if(f)a.camera.look(o[f][+!!s.shiftKey]),a.markMoving();else if(s.key===`?`)Jf(!1);else if(s.key===`\\`)t.setBefore(!0);else if(d===`b`)t.setTool(t.isBrushOn?`look`:`brush`);else if(d===`p`&&!t.shape?.graph)t.setTool(t.isGrabOn?`look`:`grab`);else if(d===`n`)U.mode=U.mode===`add`?`subtract`:`add`,t.emit(`tool`);else if(d===`j`)U.mode=U.mode===`smooth`?`add`:`smooth`,t.emit(`tool`);else if(d===`g`)Of(t,s.shiftKey?`shrink`:`grow`);else if(d===`u`)Of(t,`blur`);else if(d===`Enter`&&t.lineDrawing)t.lineDrawing.end();else if(d===`[`)n.resizeBrush(1/1.15);else if(d===`]`)n.resizeBrush(1.15);else if(d===`s`)r.toggleSplit();else if(d===`m`)r.cycleStyle();else if(d===`c`)r.toggleChange();else if(d===`x`)r.toggleClip();else if(d===`f`||d===`Home`){if(d===`Home`&&c instanceof HTMLInputElement)return;a.camera.frame(),a.markMoving()}else if(d===`l`)t.addLayer(e.layerName(t.layers.length+1),null);else if(d===`e`)Yf();else if(d===`,`||d===`.`){let{layers:e}=t,n=e.indexOf(t.layer)+(d===`.`?1:-1);e[n]&&t.select(e[n].key)}else if(d===`Escape`){if(n.escape())return;t.setTool(`look`)}else if(c===a.canvas&&s.key.startsWith(`Arrow`)){let[e,t]={ArrowLeft:[-24,0],ArrowRight:[24,0],ArrowUp:[0,-24],ArrowDown:[0,24]}[s.key];s.shiftKey?a.camera.pan(e,t):a.camera.turn(e,t),a.markMoving()}else if(c===a.canvas&&(d===`+`||d===`-`||d===`=`)){let e=a.canvas.getBoundingClientRect();a.camera.zoom(d===`-`?1.15:1/1.15,e.width/2,e.height/2),a.markMoving()}else return;s.preventDefault()}),window.addEventListener(`keyup`,e=>{e.key===`\\`&&t.setBefore(!1)}),window.addEventListener(`blur`,()=>t.setBefore(!1))}function Zf(e,t,n){let r=r=>n(e.map((e,n)=>n===t?{...e,...r}:e));return{on:re(e[t]),toggled:()=>r({on:!re(e[t])}),removed:()=>n(e.filter((e,n)=>n!==t)),renamed:e=>r({name:e})}}function Qf(t){let{doc:n}=t,r=e=>({...t.doc,clones:e});return n.clones.map((i,a)=>({id:`clone-${a}`,name:i.name||e.cloneItem(a+1),note:e.cloneNote(i.source,i.targets.length),show:()=>np(t,i.targets[0]??i.source),...Zf(n.clones,a,r),moved:e=>{let t=a+e;if(t<0||t>=n.clones.length)return null;let i=[...n.clones];return[i[a],i[t]]=[i[t],i[a]],r(i)}}))}function $f(t){let{pose:n}=t.doc;if(!n)return[];let r=e=>{let n=e.handle.length===0&&!e.fixed;return{...t.doc,pose:n?null:e}},i=n.handle.map((i,a)=>{let o=_e(i);return{id:`handle-${a}`,name:i.name||e.handleItem(a+1),note:e.handleNote(o,H(Math.hypot(...i.by))),show:()=>o!==null&&np(t,o),...Zf(n.handle,a,e=>r({...n,handle:e})),moved:null}});return n.fixed?[{id:`pins`,name:e.pinsItem,note:e.pinsNote(ve(n).length),on:n.pinned!==!1,show:()=>t.setTool(`grab`),toggled:()=>r({...n,pinned:n.pinned===!1}),removed:()=>r({...n,fixed:null}),renamed:null,moved:null},...i]:i}function ep(t){let{turned:n}=t.doc;return n.map(r=>({id:`turned-${r}`,name:e.turnedItem,note:e.turnedNote(r),on:!0,show:()=>np(t,r),toggled:null,removed:()=>({...t.doc,turned:Kd(n,[r],!1)}),renamed:null,moved:null}))}function tp(t){let{fields:n}=t.doc,r=t.shape?.presets??[];return n.filter(e=>!L(e.layers)||!re(e)).map(n=>{let i=n.layers.map(e=>Ve(e,r)).filter(e=>e!==``);return{id:`field-${n.field}`,name:e.fieldItem(n.field),note:i.join(`; `),on:re(n),show:()=>t.showTarget(n.field),toggled:()=>({...t.doc,fields:t.doc.fields.map(e=>e.field===n.field?{...e,on:!re(e)}:e)}),removed:()=>({...t.doc,fields:t.doc.fields.filter(e=>e.field!==n.field)}),renamed:null,moved:null}})}function np(e,t){e.view.showMark(e.view.arrays.place(t))}function rp(t,r,i){let{name:o,on:s,moved:c}=r,l=e=>e&&t.history.commit(e),u=r.toggled,d=n(`button`,{type:`button`,class:`name`,title:r.renamed?e.renameHint:void 0,onclick:r.show,ondblclick:r.renamed?i:void 0},n(`span`,{},o),n(`small`,{},r.note));return n(`li`,{class:s?``:`off`,"data-item":r.id},u?a(s?`eye`:`off`,s?e.layerOff(o):e.layerOn(o),()=>l(u()),{"aria-pressed":String(s)}):n(`span`,{class:`no-eye`}),d,c?.(-1)?a(`up`,e.moveUp(o),()=>l(c(-1))):null,c?.(1)?a(`down`,e.moveDown(o),()=>l(c(1))):null,a(`bin`,e.remove(o),()=>l(r.removed())))}function ip(t,r,i,a){let o=n(`input`,{type:`text`,value:i.name,"aria-label":e.itemRename(i.name)});r.querySelector(`[data-item="${CSS.escape(i.id)}"] .name`)?.replaceWith(o),o.select();let s=!1;o.addEventListener(`blur`,()=>{let e=o.value.trim();!s&&e!==i.name&&t.history.commit(i.renamed(e)),a()}),o.addEventListener(`keydown`,e=>{s=e.key===`Escape`,(e.key===`Enter`||s)&&o.blur()})}function ap(t){let r=n(`ul`,{class:`layers`,"aria-label":e.onTop}),i=n(`div`,{class:`edit-list`,hidden:!0},n(`h3`,{},e.onTop),r),a=()=>{let e=t.shape&&!t.isGrid?op(t):[];i.hidden=e.length===0,r.replaceChildren(...e.map(e=>rp(t,e,()=>ip(t,r,e,a))))};return t.on([`doc`,`shape`,`levels`,`target`],a),i}function op(e){return[...Qf(e),...$f(e),...ep(e),...tp(e)]}function sp(t,n){t.layers.length===1?t.showMessage(e.lastLayer):t.history.commit(t.withLayers(t.layers.filter(e=>e.key!==n)))}function cp(t,n){let r=t.layers.findIndex(e=>e.key===n.key),i={...n,key:_(),name:e.copyName(n.name||e.layerName(r+1))};t.history.commit(t.withLayers(t.layers.toSpliced(r+1,0,i))),t.select(i.key)}function lp(e,t){let n=Ve(t,e.shape?.presets??[]);return[n!==``&&t.region===null?``:qf(t.region),n].filter(e=>e!==``).join(` · `)}function up(t,r,i,o){let s=r.name||e.layerName(i+1),c=r.key===t.layer.key,l=n(`button`,{type:`button`,class:`name`,"aria-pressed":String(c),title:e.renameHint,onclick:()=>t.select(r.key),ondblclick:()=>o(s)},n(`span`,{},s),n(`small`,{},lp(t,r)));return n(`li`,{class:c?`selected`:``,"data-key":String(r.key)},a(r.on?`eye`:`off`,r.on?e.layerOff(s):e.layerOn(s),()=>t.changeLayer({on:!r.on},!0,r.key),{"aria-pressed":String(r.on)}),l,a(`copy`,e.duplicate(s),()=>cp(t,r)),a(`bin`,e.remove(s),()=>sp(t,r.key)))}function dp(t,r,i,a,o){let s=n(`input`,{type:`text`,value:a,"aria-label":e.layerRename});r.querySelector(`[data-key="${i.key}"] .name`)?.replaceWith(s),s.select(),s.addEventListener(`blur`,()=>{t.changeLayer({name:s.value.trim()},!0,i.key),o()}),s.addEventListener(`keydown`,e=>{e.key===`Enter`&&s.blur(),e.key===`Escape`&&(s.value=i.name,s.blur())})}function fp(t){let r=s(e.opacity,{min:0,max:100,step:1,value:100},e=>`${e} %`,(e,n)=>{t.timings.startSliderTiming(),t.changeLayer({opacity:e/100},!1),n&&t.history.end()}),i=l(e.tint,t.tint.region,e=>{t.tint[t.tintKind]=e,t.updateTint(),t.emit(`tint`)}),a=i.querySelector(`input`),o=n(`div`,{class:`where`}),c,u=-1;return{element:n(`div`,{class:`detail`},r,o,i),show:()=>{let{layer:e}=t;r.set(Math.round(100*e.opacity)),i.hidden=e.region===null,a.checked=t.tint[t.tintKind],(c!==e.region||u!==e.key)&&(c=e.region,u=e.key,o.replaceChildren(Wf(t)))},reset:()=>{u=-1}}}function pp(t){let r=n(`details`,{class:`rules`}),i=()=>{let{doc:i}=t,a=e=>t.history.commit({...t.doc,...e});r.replaceChildren(n(`summary`,{},e.rules),c(e.along,e.alongChoices,i.along??`free`,e=>a({along:e===`free`?null:e})),c(e.border,e.borderChoices,i.border??`natural`,e=>a({border:e})),...t.shape?.volume==null&&(i.volume??`free`)===`free`?[]:[c(e.volumeRule,e.volumeChoices,i.volume??`free`,e=>a({volume:e}))])};t.on(`shape`,i);let a=``;return t.on(`doc`,()=>{let e=`${t.doc.along} ${t.doc.border} ${t.doc.volume}`;e!==a&&i(),a=e}),r}function mp(t){let r=n(`ul`,{class:`layers`,"aria-label":e.layers}),i=fp(t),o=()=>{r.replaceChildren(...t.layers.map((e,n)=>up(t,e,n,n=>dp(t,r,e,n,o)))),i.show()};t.on(`drawing`,()=>{i.reset(),o()}),t.on([`doc`,`selected`,`shape`],o);let s=pp(t);return t.on(`target`,()=>{s.hidden=t.target!==null||t.shape?.graph?.placed===!0,i.reset(),o()}),n(`section`,{class:`layers-panel`,id:`layers`,role:`tabpanel`,"aria-label":e.layers},n(`header`,{},n(`h2`,{},e.layers),n(`span`,{class:`space`}),a(`plus`,e.addLayer,()=>{t.addLayer(e.layerName(t.layers.length+1),null)})),r,i.element,s,ap(t))}var hp=[0,0,0,-1];function gp({axis:e,at:t,flipped:n},{low:r,high:i}){let a=n?-1:1,o=r[e]+t*(i[e]-r[e]);return[...[0,0,0].with(e,a),-a*o]}function _p([e,t,n,r],i,a=0){return e*i[a]+t*i[a+1]+n*i[a+2]+r>0}function vp(e){let t=e;return typeof t==`object`&&t&&[0,1,2].includes(t.axis)&&t.at>=0&&t.at<=1&&typeof t.flipped==`boolean`?{axis:t.axis,at:t.at,flipped:t.flipped}:null}var yp=`deviation`,bp=class{studio;other=null;about=null;turn=0;constructor(e){this.studio=e,e.on(`shape`,()=>this.end()),e.on(`shapes`,()=>{let{other:t}=this;t&&!e.shapes.shapes.some(e=>e.id===t.id)&&this.end()})}async show(t){let{studio:n}=this,{api:r,view:i}=n,a=n.shape,o=++this.turn,s=await n.wait(e.besideLoading,()=>Promise.all([r.shape(t),r.floats(`shapes/${t}/exact`),r.indices(`shapes/${t}/triangles`)]));if(!s||o!==this.turn||n.shape?.id!==a.id)return;let[c,l,u]=s,d=c.mean_length||c.diagonal/100,{normals:f}=await n.engine.call(`normalsOf`,{positions:l.slice(),triangles:u});if(o!==this.turn)return;for(let e=0;e<l.length;e++)l[e]+=c.center[e%3]-a.center[e%3];let p=Te(c)?`both`:`front`;i.setBeside({positions:l,normals:f,triangles:u,meanLength:d,lit:p}),this.other=c,n.emit(`beside`),n.showColors(yp)}end(){this.turn++,this.other&&(this.other=null,this.about=null,this.studio.view.setBeside(null),this.studio.emit(`beside`))}async measure(){let{studio:t,other:n,turn:r}=this,{api:i,shape:a}=t;if(!n||!a)return null;await t.saver?.waitUntilSent();let o=async e=>({own:await i.deviation(a.id,n.id,e),back:await i.deviation(n.id,a.id,e)}),s=this.about?await o(new AbortController().signal):await t.wait(e.measuring,o);return!s||r!==this.turn?null:(this.about=s.own.about,t.emit(`beside`),{own:s.own.values,other:s.back.values,about:s.own.about})}labels(){let{studio:t}=this,r=n(`div`,{class:`beside-labels`,hidden:!0});return t.on(`beside`,()=>{let{other:i,about:o}=this;if(r.hidden=i===null,!i)return;let s=o?e.deviationFigures(o.rms===null?`–`:H(o.rms),o.greatest===null?`–`:H(o.greatest)):``;r.replaceChildren(n(`span`,{},n(`b`,{},t.shape.name),s?n(`small`,{},s):null),n(`span`,{},n(`b`,{},i.name),a(`close`,e.besideEnd,()=>this.end())))}),r}section(t){let{studio:r}=this,i=r.shapes.shapes.filter(e=>e.id!==r.shape?.id),a=(e,r)=>n(`button`,{type:`button`,onclick:()=>{t(),r()}},e);return[n(`h3`,{},e.beside),n(`p`,{},i.length>0?e.besideNote:e.besideNone),n(`div`,{class:`row`},...i.map(e=>a(e.name,()=>{this.show(e.id).catch(e=>r.showMessage(e.message,`error`))})),this.other?a(e.besideEnd,()=>this.end()):null)]}},xp=[[.2777273272234177,.005407344544966578,.3340998053353061],[.1050930431085774,1.404613529898575,1.384590162594685],[-.3308618287255563,.214847559468213,.09509516302823659],[-4.634230498983486,-5.799100973351585,-19.33244095627987],[6.228269936347081,14.17993336680509,56.69055260068105],[4.776384997670288,-13.74514537774601,-65.35303263337234],[-5.435455855934631,4.645852612178535,26.3124352495832]],Sp=[[.13,.28,.6],[.37,.57,.82],[.93,.92,.9],[.86,.48,.36],[.6,.11,.16]],Cp=[[.12,.47,.71],[1,.73,.47],[.17,.55,.24],[.84,.15,.16],[.77,.69,.84],[.55,.34,.29],[.97,.71,.82],[.09,.75,.81],[.74,.74,.13],[.42,.24,.6],[.68,.78,.91],[.45,.45,.45]],wp=48;function Tp(e){let t=new Set;for(let n of e)if(!Number.isNaN(n)&&(!Number.isInteger(n)||(t.add(n),t.size>wp)))return null;return t.size>1?[...t].sort((e,t)=>e-t):null}function Ep(e,t){let n=Math.min(1,Math.max(0,t)),r;if(e===`viridis`)r=[0,1,2].map(e=>xp.reduceRight((t,r)=>t*n+r[e],0));else if(e===`classes`)r=Cp[Math.round(255*n)%Cp.length];else if(e===`gray`)r=[.15+.8*n,.15+.8*n,.15+.8*n];else{let e=n*(Sp.length-1),t=Math.min(Sp.length-2,Math.floor(e));r=[0,1,2].map(n=>Sp[t][n]*(1-(e-t))+Sp[t+1][n]*(e-t))}return r.map(e=>Math.round(255*Math.min(1,Math.max(0,e))))}function Dp(e){let t=new Uint8Array(1024);for(let n=0;n<256;n++)t.set([...Ep(e,n/255),255],4*n);return t}function Op(e){let t=0;for(let n of e)n>t&&(t=n);return t>0?e.filter(e=>e>.001*t):e}function kp(e,[t,n],r){let i=Array(r).fill(0),a=r/(n-t),o=Math.max(1,Math.floor(e.length/2e5));for(let n=0;n<e.length;n+=o){let o=e[n];if(!Number.isFinite(o))continue;let s=Math.floor((o-t)*a);i[Math.min(r-1,Math.max(0,s))]++}return i}function Ap(e){return e.some(e=>Number.isFinite(e))}function jp(e,t,n){if(typeof t==`object`)return[t.low,t.high];let r=Math.max(1,Math.floor(e.length/2e4)),i=[];for(let t=0;t<e.length;t+=r)Number.isFinite(e[t])&&i.push(e[t]);if(i.length===0)return[0,1];i.sort((e,t)=>e-t);let a=i[0],o=i.at(-1);if(t===`most`)a=i[Math.floor(.02*(i.length-1))],o=i[Math.ceil(.98*(i.length-1))];else for(let t of e)t<a&&(a=t),t>o&&(o=t);if(n){let e=Math.max(Math.abs(a),Math.abs(o))||1;return[-e,e]}return a>=0&&a<.2*o&&(a=0),o>a?[a,o]:[a,a+(Math.abs(a)||1)]}function Mp(e){return e.name!==`change`&&!/^band-\d+$/.test(e.name)}var Np=12,Pp={bins:32,height:24,color:`rgb(132 136 140)`};function Fp(t){let{view:r}=t,i=`none`,a=null,o=null,s=null,l=``,u=``,d=!1,f=`viridis`,p=`most`,m=null,h=Ke(ne),g=null,_=n(`select`,{"aria-label":e.colors,onchange:()=>void I(_.value)}),v=c(e.map,e.maps,`viridis`,e=>{f=e,M()}),y=c(e.range,[[`most`,e.rangeMost],[`all`,e.rangeAll]],`most`,e=>{p=e,M()}),b=n(`input`,{type:`number`,step:`any`,"aria-label":e.rangeLow,onchange:()=>w()}),x=n(`input`,{type:`number`,step:`any`,"aria-label":e.rangeHigh,onchange:()=>w()}),C=()=>{},w=()=>{Number.isFinite(b.valueAsNumber)&&Number.isFinite(x.valueAsNumber)&&(C(),b.valueAsNumber>=x.valueAsNumber?C=t.showMessage(e.badRange,`error`):(p={low:b.valueAsNumber,high:x.valueAsNumber},M()))},T=n(`div`,{class:`color-options`,hidden:!0},v,y,n(`div`,{class:`row`},b,x)),E=n(`canvas`,{width:256,height:1,"aria-hidden":`true`}),D=n(`span`,{class:`legend-title`}),O=n(`canvas`,{width:256,height:Pp.height,class:`histogram`,"aria-hidden":`true`}),k=n(`div`,{class:`legend-numbers`}),A=n(`ul`,{class:`swatches`,hidden:!0}),j=n(`figure`,{class:`legend`,hidden:!0},n(`figcaption`,{},D),O,E,k,A);function M(){if(!a){j.hidden=!0;return}if(A.hidden=!0,E.hidden=!1,O.hidden=!0,D.textContent=u?`${l} (${u})`:l,g){P(g);return}let t=m?.sample??o??a;if(!Ap(t)){E.hidden=!0,k.replaceChildren(n(`span`,{},e.noValues)),j.hidden=!1;return}let s=jp(i===`change`?Op(t):t,p,d);r.setScalarRange(s,f);let c=E.getContext(`2d`);for(let e=0;e<256;e++){let[t,n,r]=Ep(f,e/255);c.fillStyle=`rgb(${t} ${n} ${r})`,c.fillRect(e,0,1,1)}N(s),k.replaceChildren(...[0,.5,1].map(e=>{let t=s[0]+e*(s[1]-s[0]);return n(`span`,{},H(Math.abs(t)<.001*(s[1]-s[0])?0:t))})),document.activeElement!==b&&(b.value=s[0].toPrecision(4)),document.activeElement!==x&&(x.value=s[1].toPrecision(4)),j.hidden=!1}function N(e){let t=kp(a,e,Pp.bins),n=Math.max(...t);if(O.hidden=n===0,n===0)return;let r=O.getContext(`2d`);r.clearRect(0,0,O.width,O.height),r.fillStyle=Pp.color;let i=O.width/Pp.bins;for(let[e,a]of t.entries()){let t=Math.round(O.height*a/n);r.fillRect(e*i,O.height-t,i-1,t)}}function P(e){r.setScalarRange([0,255],`classes`),E.hidden=!0,k.replaceChildren();let t=e.slice(0,Np);A.replaceChildren(...t.map((e,t)=>{let[r,i,a]=Ep(`classes`,t/255);return n(`li`,{},n(`i`,{style:`background: rgb(${r} ${i} ${a})`}),String(e))}),e.length>t.length?n(`li`,{},`+ ${e.length-t.length}`):``),A.hidden=!1,j.hidden=!1}let F=0;async function I(n){let s=++F,c=n!==i,h=ee(i);i=n,_.value=ee(n),T.hidden=n===`none`,g=null;let b=te(n);n!==`deviation`&&r.setBesideScalar(null);let x=t.shape?.fields.find(e=>`field-${e.name}`===n);if(re(x?.editable?x.name:null),n===`none`||x?.rgb){if(a=null,o=null,T.hidden=!0,x?.rgb){try{let e=await t.api.colors(t.shape.id,x.name);s===F&&r.setRgb(e)}catch(e){t.showMessage(e.message,`error`)}M();return}r.setScalar(null),M()}else{try{if(n===`deviation`){let n=await t.beside.measure();if(s!==F)return;if(!n){I(`none`);return}a=n.own,o=null,l=e.deviation(t.beside.other.name),u=e.modelUnits,d=n.about.signed,r.setBesideScalar(n.other)}else if(n===`change`||n.startsWith(`band-`)){let r=n===`change`?0:Number(n.slice(5));n===`change`&&await t.display.waitUntilSettled();let i=await t.engine.call(`scalar`,r?{band:r}:`change`);if(s!==F)return;a=i.values,o=null,l=r?e.bandSize(r):e.change,u=``,d=!1}else{let e=await t.api.field(t.shape.id,n.slice(6));if(s!==F)return;let r=x?.editable?await ie(x.name):null;if(s!==F)return;if(b.length<2)m=null;else if(m?.name!==b[0].name){let e=await t.api.seriesSample(t.shape.id,b[0].name);if(s!==F)return;m={name:b[0].name,sample:e}}a=r??e.values,o=r&&e.values,l=e.info.label,u=e.info.unit,d=e.info.diverging,x?.edited||r||m||(g=Tp(a))}}catch(e){if(s!==F)return;t.showMessage(e.message,`error`),c&&I(`none`);return}if(n.startsWith(`field-`)||(m=null),c&&h!==ee(n)&&(p=`most`,f=d?`diverging`:`viridis`,v.querySelector(`select`).value=f,y.querySelector(`select`).value=`most`),T.hidden=g!==null,g){let e=new Map(g.map((e,t)=>[e,t]));r.setScalar(a.map(t=>e.get(t)??NaN),[0,255],`classes`)}else r.setScalar(a,[0,1],f,o);M()}}function ee(e){if(!e.startsWith(`field-`)||!t.shape)return e;let n=Ue(t.shape,e.slice(6))[0];return n?`field-${n.name}`:e}function te(e){let n=t.shape&&e.startsWith(`field-`)?Ue(t.shape,e.slice(6)):[];return h.set(n,n.findIndex(t=>`field-${t.name}`===e)),n}async function ne(e,n){if(n)return I(`field-${e.name}`);let s=++F,c=e.editable?S(t.doc,e.name):null,{id:u}=t.shape;try{let n=c!==null&&!L(c)?await t.api.editedField(u,e.name):(await t.api.field(u,e.name)).values;if(s!==F)return;i=`field-${e.name}`,a=n,l=e.label,o?r.setScalar(a,[0,1],f):r.updateScalar(a),o=null,r.markMoving(),M()}catch(e){if(s!==F)return;h.stop(),t.showMessage(e.message,`error`)}}function re(e){let n=t.shape?.graph?.placed;if(n&&e===null&&t.shownField!==null)return;let r=e!==t.shownField;r&&(t.shownField=e,t.emit(`target`)),(t.target!==null||r&&n)&&t.target!==e&&t.setTarget(e)}async function ie(e){let{fieldEditor:n}=t;if(s=S(t.doc,e),t.target===e)return n.loaded===e?n.values:null;if(!s||L(s))return null;let r=t.shape.id;return await t.saver?.waitUntilSent(),t.api.editedField(r,e)}let ae=0;function oe(){ae===0&&(ae=window.setTimeout(()=>{ae=0,M()},150))}t.on(`fieldEdited`,()=>{let{fieldEditor:e,shownField:n}=t;if(!e.values||e.loaded!==n||i!==`field-${n}`||!a)return;let c=g!==null;g=null,a=e.values,s=S(t.doc,n);let l=o===null;o=e.before,l||c?(T.hidden=!1,r.setScalar(a,[0,1],f,o),M()):(r.updateScalar(a),r.markMoving(),oe())}),t.on([`target`,`saving`],()=>{let{shownField:e,target:n,saver:r,doc:a}=t;e!==null&&n===null&&r?.state===`saved`&&(S(a,e)!==s||R)&&(R=!1,I(i))});let R=!1;t.on(`target`,()=>{R||=t.target!==null});let se=e=>[..._.options].some(t=>t.value===ee(e)),ce=0;function le(){let r=t.shape;if(!r)return;let a=new Map,o=r.fields.filter(Mp).filter(e=>{if(!e.series)return!0;let t=a.get(e.series.name)??0;return a.set(e.series.name,t+1),t===0}),s=t=>t.series?e.seriesOf(t.series.name,a.get(t.series.name)):t.label;m=null,_.replaceChildren(n(`option`,{value:`none`},e.noColors),r.graph?.placed?``:n(`option`,{value:`change`},e.change),t.beside.other?n(`option`,{value:yp},e.deviation(t.beside.other.name)):``,n(`optgroup`,{label:e.fields},...o.map(e=>n(`option`,{value:`field-${e.name}`},s(e)))),n(`optgroup`,{label:e.bandSizes},...(r.graph?.placed?[]:r.levels).map(t=>n(`option`,{value:`band-${t.level}`},e.band(t.level,H(t.sigma)))))),I(se(i)&&r.id===ce?i:`none`),ce=r.id}t.on([`levels`,`fields`],le);let ue=null;t.on(`beside`,()=>{let e=t.beside.other?.id??null;e!==ue&&le(),ue=e});let de=0;return t.on(`moved`,()=>{!(i===`change`||i===`deviation`||t.shape?.fields.some(e=>e.edited&&i===`field-${e.name}`))||i!==`change`&&t.saver?.state!==`saved`||(window.clearTimeout(de),de=window.setTimeout(()=>void I(i),60))}),{controls:[n(`label`,{class:`field`},n(`span`,{},e.colors),_),T],legend:j,frames:h.element,get shown(){return i},show:e=>{se(e)&&I(e)},toggleChange:()=>{se(`change`)&&I(i===`change`?`none`:`change`)},valueAt:t=>{if(!a)return``;let n=o&&o[t]!==a[t]?e.valueBefore(H(o[t])):``;return`, ${l} ${H(a[t])}${u?` ${u}`:``}${n}`}}}var Ip=30;function Lp(e){let t=e.shape?.inward??[],n=e.doc.turned.filter(e=>!t.some(t=>t.vertex===e));return[...t.map(e=>({vertex:e.vertex,nFaces:e.n_faces})),...n.map(e=>({vertex:e,nFaces:null}))]}function Rp(t){let r=n(`div`,{class:`faces`,role:`group`,"aria-label":e.faces}),i=({vertex:r,nFaces:i},o)=>{let s=t.doc.turned.includes(r),c=l(o?e.turnOnly:e.turnPart(r,i===null?null:we(i)),s,e=>t.turnedParts.set([r],e));return o?c:n(`div`,{class:`row part`},c,a(`frame`,e.showPart(r),()=>{t.view.showMark(t.view.arrays.place(r))}))},o=()=>{let a=t.shape&&!t.isGrid?Lp(t):[];if(r.hidden=a.length===0,a.length===0){r.replaceChildren();return}let o=qd(t.shape,t.doc.turned),s=a.length===1&&t.shape.components===1;r.replaceChildren(...a.slice(0,Ip).map(e=>i(e,s)),...a.length>Ip?[n(`p`,{class:`hint`},e.moreParts(a.length-Ip))]:[],...a.length>1?[n(`button`,{type:`button`,disabled:o.length===0,onclick:()=>t.turnedParts.set(o,!0)},e.turnAll)]:[])},s=null;return t.on(`shape`,o),t.on(`doc`,()=>{t.doc.turned!==s&&o(),s=t.doc.turned}),r}function zp(t,r){let i=async()=>{try{let e=await t.turnedParts.partAt(r);e!==null&&t.turnedParts.set([e],!t.doc.turned.includes(e))}catch(e){t.showMessage(e.message,`error`)}};return n(`button`,{type:`button`,onclick:()=>void i()},e.turnPartHere)}var Bp=.7;function Vp(t){let{view:n}=t,r=s(e.pointSize,{min:25,max:400,step:25,value:100},e=>`${e} %`,e=>{n.pointScale=e/100,n.markMoving()}),i=()=>!!t.shape?.graph,a=[`shaded`,`matcap`,`flat`,`edges`],c=e=>{n.style=e,l.set(e),e===`edges`&&!n.hasEdges&&t.shape&&t.shape.n_triangles>0&&t.engine.call(`edges`,{}).then(({pairs:e})=>n.setEdges(e)),n.request()},l=o(e.style,a.map(t=>[t,e.styles[t]]),`shaded`,c);return t.on(`shape`,()=>{let e=t.shape.n_triangles===0;r.hidden=!e,l.hidden=i(),l.querySelector(`button:last-child`).hidden=e,c(e&&n.style===`edges`?`shaded`:n.style)}),{controls:[l,Rp(t),r],setStyle:c,cycle:()=>{if(i())return;let e=a.filter(e=>e!==`edges`||t.shape?.n_triangles!==0);c(e[(e.indexOf(n.style)+1)%e.length])}}}function Hp(t,r,i){let{view:o}=t,c=[],u=[],d=null,f=n(`output`,{}),p=n(`div`,{}),m=n(`div`,{class:`card`,hidden:!0},n(`div`,{},f,p),a(`close`,e.closeCard,()=>h())),h=()=>{m.hidden=!0,o.showMark(null)},g=(e,t,n=null)=>{f.replaceChildren(...e),p.replaceChildren(...n?[n]:[]),m.hidden=!1,o.showMark(t)};t.on([`moved`,`fieldEdited`],h);let _=l(e.features,!1,n=>{if(h(),!n){c=[],u=[],b.hidden=!0,o.showFeatures([],1),o.request();return}let{id:r}=t.shape;t.api.features(r).then(n=>{_.querySelector(`input`).checked&&t.shape?.id===r&&(c=n,v=Math.max(1,Math.min(100,Math.round(2e4/Math.max(1,n.length)))),y(),b.set(v),b.hidden=n.length===0,t.showMessage(e.nFeatures(n.length)))},e=>t.showMessage(e.message,`error`))}),v=100,y=()=>{let e=[...c].sort((e,t)=>t.strength-e.strength);u=e.slice(0,Math.ceil(v/100*e.length)),o.showFeatures(u,Bp),o.request()},b=s(e.strongest,{min:1,max:100,step:1,value:v},t=>e.shownOf(Math.ceil(t/100*c.length),c.length),e=>{v=e,y()});return b.hidden=!0,t.on(`shape`,()=>{c=[],u=[],d=null,b.hidden=!0,_.querySelector(`input`).checked=!1,_.hidden=t.shape.graph?.placed===!0,h()}),r.onClick=(r,a,s)=>{let c=null,l=18;for(let e of u){if(o.hides(e.position))continue;let t=o.camera.project(e.position),n=Math.hypot(t.x-a,t.y-s);n<l&&(l=n,c=e)}if(c){let{vertex:r,sigma:i,strength:a,level:o}=c;g([n(`div`,{},e.feature(r,H(i),H(a),o)),n(`button`,{type:`button`,onclick:()=>t.addLayer(e.layerName(t.layers.length+1),{ball:{center:{vertex:r},radius:i}})},e.layerHere)],null);return}if(!r.hit){h();return}let{vertex:f,point:p}=r.hit,{center:m}=t.shape,_=p.map((e,t)=>e+m[t]),v=d&&Math.hypot(..._.map((e,t)=>e-d[t]));d=_;let y=t.shape.graph?.placed===!0,b=[`${e.vertex(f)}${i(f)}`,y?``:e.place(_.map(e=>H(e,4)).join(`, `)),v===null||y?``:e.distance(H(v,4))].filter(e=>e!==``).map(e=>n(`div`,{},e));g(b,p,t.shape.n_triangles>0?zp(t,f):null),t.shape.graph?.named&&t.api.name(t.shape.id,f).then(e=>b[0].prepend(n(`b`,{},e),` · `),e=>t.showMessage(e.message,`error`))},{controls:[_,b],card:m}}function Up(t){let{view:r}=t,i=n(`div`,{class:`row`},...e.views.map(([e,t])=>n(`button`,{type:`button`,onclick:()=>{r.camera.look(e),r.camera.frame(),r.markMoving()}},t)),a(`frame`,e.frame,()=>{r.camera.frame(),r.markMoving()})),s=o(e.turning,[[`turntable`,e.turntable],[`trackball`,e.trackball]],`turntable`,e=>{r.camera.trackball=e===`trackball`,s.set(e),e===`turntable`&&r.camera.level(),r.markMoving()}),c=o(e.upright,[[`y`,e.upY],[`z`,e.upZ]],`y`,e=>{r.camera.up=e,c.set(e),r.camera.start(),r.markMoving()}),l=n(`details`,{},n(`summary`,{},e.camera),n(`div`,{class:`stack`},s,c));return t.on([`shape`,`camera`],()=>{c.set(r.camera.up),s.set(r.camera.trackball?`trackball`:`turntable`);for(let e of[...i.children].slice(0,-1))e.hidden=r.camera.isFlat;l.hidden=r.camera.isFlat}),[i,l]}function Wp(t){let{view:r}=t,i={axis:0,at:.5,flipped:!1},a=e=>{e&&(i=e),r.setClip(e),r.markMoving(),f()},c=o(e.clip,[[`off`,e.clipOff],[`x`,`x`],[`y`,`y`],[`z`,`z`]],`off`,e=>a(e===`off`?null:{...i,axis:`xyz`.indexOf(e)})),u=s(e.clipAt,{min:0,max:100,step:.5,value:50},e=>t.shape?H(r.clipPlace({...i,at:e/100})+t.shape.center[i.axis]):``,e=>a({...i,at:e/100})),d=l(e.clipFlip,!1,e=>a({...i,flipped:e})),f=()=>{let{clip:e}=r;c.set(e?[`x`,`y`,`z`][e.axis]:`off`),u.hidden=e===null,d.hidden=e===null,u.set(100*i.at),d.querySelector(`input`).checked=i.flipped};return t.on(`shape`,f),f(),{controls:[n(`div`,{class:`field`},n(`span`,{},e.clip),c),u,d],set:a,toggle:()=>a(r.clip?null:i)}}function Gp(t){let{view:r}=t,i=n(`div`,{class:`divider`,hidden:!0,role:`slider`,tabIndex:0,"aria-label":e.split,"aria-valuemin":`0`,"aria-valuemax":`100`}),a=[n(`span`,{},e.beforeShort),n(`span`,{},e.afterShort)];i.append(...a);let o=e=>{r.split=Math.min(.98,Math.max(.02,e)),i.style.left=`${100*r.split*(r.halves===`beside`?.5:1)}%`,i.setAttribute(`aria-valuenow`,String(Math.round(100*r.split))),r.markMoving()};i.addEventListener(`pointerdown`,e=>i.setPointerCapture(e.pointerId)),i.addEventListener(`pointermove`,e=>{if(!i.hasPointerCapture(e.pointerId))return;let t=r.canvas.getBoundingClientRect();o((e.clientX-t.left)/(t.width*(r.halves===`beside`?.5:1)))}),i.addEventListener(`keydown`,e=>{let t={ArrowLeft:-.02,ArrowRight:.02,PageDown:-.1,PageUp:.1}[e.key];t!==void 0&&(e.preventDefault(),e.stopPropagation(),o((r.split??.5)+t))});let s=()=>{r.split!==null&&o(r.split)};t.on(`beside`,s),window.addEventListener(`resize`,s),t.on(`compared`,()=>{let{comparison:n}=t;a[0].textContent=n?e.compareShort[n.method]:e.beforeShort,a[1].textContent=n?e.thisEdit:e.afterShort,t.updateTint(),n&&r.split===null&&c()});let c=()=>{r.split===null?o(.5):r.split=null,i.hidden=r.split===null,r.request(),t.emit(`before`)};return{divider:i,toggleSplit:c}}function Kp(t){let r=n(`dl`,{class:`readouts`,"aria-live":`off`});function i(){let i=t.shape;if(!i)return;let{displacement:a}=t,o=(e,t)=>n(`div`,{},n(`dt`,{},e),n(`dd`,{},t)),s=e=>` (${H(100*e/i.diagonal,2)} %)`,{graph:c}=i,l=[o(c?e.nodes:i.kind===`cloud`?e.points:e.vertices,we(i.n_vertices))];if(c&&l.push(o(e.graphEdges,we(c.n_edges))),t.target!==null){let{change:n}=t.fieldEditor;l.push(o(e.fieldGreatest,n?H(n.greatest):`–`)),l.push(o(e.fieldRms,n?H(n.rms):`–`)),r.replaceChildren(...l);return}if(c?.placed){r.replaceChildren(...l);return}l.push(o(e.greatest,a?H(a.greatest)+s(a.greatest):`0`)),l.push(o(e.rms,a?H(a.rms):`0`));let{volume:u}=t.turnedParts,d=a?a.volume:u===null?null:[u,u];if(d){let[n,r]=d,a=n===0?0:100*(r-n)/Math.abs(n),s=a>.005?`+`:``;l.push(o(qd(i,t.doc.turned).length>0?e.volumeInward:e.volume,`${H(n,4)} → ${H(r,4)} (${s}${Math.abs(a)<.005?`0`:H(a,2)} %)`))}r.replaceChildren(...l)}return t.on([`shape`,`moved`,`target`,`fieldEdited`,`turned`],i),r}var qp=[`classification`,`intensity`,`reflectance`,`scalar_Intensity`];function Jp(e){return e?.kind===`graph`?e.fields.find(e=>e.editable)?.name??null:null}function Yp(e){if(!e)return null;if(e.kind===`graph`)return`field-${Jp(e)}`;let t=e.fields.find(e=>e.rgb),n=(t?[t.name]:e.kind===`cloud`?qp:[]).find(t=>e.fields.some(e=>e.name===t));return n===void 0?null:`field-${n}`}function Xp(t,r){let i=Vp(t),a=Fp(t),o=Hp(t,r,a.valueAt),s=Wp(t),c=null,l=null,u=n=>{n&&n.style in e.styles&&i.setStyle(n.style),s.set(vp(n?.clip)),c=n?.colors??Yp(t.shape),l=n?n.target??null:Jp(t.shape)};t.shownView={get:()=>{let{camera:e,style:n}=t.view;return{camera:e.state,style:n,colors:a.shown,target:t.target,clip:t.view.clip}},set:e=>{t.view.camera.restore(e.camera),t.view.markMoving(),u(e),d(),t.emit(`camera`)}},t.on(`shape`,()=>u(Qu(t.shape)));let d=()=>{c!==null&&(((t.shape?.fields.find(e=>c===`field-${e.name}`)?.edited??!0)||l!==null)&&t.loadedBands.size<t.nLevels||(a.show(c),c=null,l!==null&&t.showTarget(l),l=null))};t.on([`levels`,`band`],d),t.showColors=e=>a.show(e),t.showField=e=>a.show(`field-${e}`);let{divider:f,toggleSplit:p}=Gp(t);return{panel:n(`section`,{class:`look-panel`,id:`look`,role:`tabpanel`,"aria-label":e.look},n(`header`,{},n(`h2`,{},e.look)),...i.controls,...a.controls,...o.controls,...s.controls,...Up(t)),legend:a.legend,frames:a.frames,card:o.card,readouts:Kp(t),divider:f,style:i.setStyle,cycleStyle:i.cycle,toggleClip:s.toggle,toggleChange:a.toggleChange,toggleSplit:p}}var Zp={least:40,most:120},Qp={length:17,half:26};function $p(e){if(!(e>0)||!Number.isFinite(e))return 0;let t=10**Math.floor(Math.log10(e));return([5,2,1].find(n=>n*t<=e*(1+1e-12))??1)*t}function em(e,t){let n=document.createElementNS(`http://www.w3.org/2000/svg`,e);for(let[e,r]of Object.entries(t))n.setAttribute(e,r);return n}function tm(t){let{half:r}=Qp,i=em(`svg`,{viewBox:`${-r} ${-r} ${2*r} ${2*r}`,class:`axes`}),a=[`x`,`y`,`z`].map((e,t)=>{let n=em(`line`,{x1:`0`,y1:`0`,class:`axis-${e}`}),r=em(`text`,{class:`axis-${e}`});return r.textContent=e,i.append(n,r),{axis:t,line:n,label:r}}),o=n(`span`,{class:`bar-line`}),s=n(`span`,{}),c=n(`div`,{class:`scale-bar`,title:e.scaleBar,"aria-hidden":`true`},i,n(`span`,{class:`bar-box`},s,o)),l=``;return t.afterFrame(()=>{let{camera:n}=t,r=n.three.quaternion,i=n.pixel,c=`${r.x} ${r.y} ${r.z} ${r.w} ${i}`;if(c===l)return;l=c;let u=r.clone().invert();for(let{axis:e,line:t,label:n}of a){let r=new J().setComponent(e,Qp.length).applyQuaternion(u);t.setAttribute(`x2`,r.x.toFixed(1)),t.setAttribute(`y2`,(-r.y).toFixed(1)),n.setAttribute(`x`,(1.32*r.x).toFixed(1)),n.setAttribute(`y`,(-1.32*r.y).toFixed(1)),n.style.opacity=r.z<-.8*Qp.length?`0.4`:`1`}let d=$p(i*Zp.most);o.style.width=`${Math.max(Zp.least,d/i).toFixed(1)}px`,s.textContent=e.units(H(d))}),c}function nm({point:e,normal:t},n){let[r,i,a]=t,o=Math.abs(r)<.8?[0,-a,i]:[a,0,-r],s=Math.hypot(...o),c=o.map(e=>e/s),l=[i*c[2]-a*c[1],a*c[0]-r*c[2],r*c[1]-i*c[0]],u=new Float32Array(384);for(let t=0;t<64;t++)for(let r of[0,1]){let i=2*Math.PI*(t+r)/64;for(let a=0;a<3;a++)u[6*t+3*r+a]=e[a]+n*(Math.cos(i)*c[a]+Math.sin(i)*l[a])}return u}var rm=1.25,im=2.5;function am(e,t,n){return Math.min(1,Math.max(0,Math.log2(e/t)/Math.log2(n/t)))}var om={smooth:(e,t)=>am(e,t/4,t),enhance:(e,t)=>1+1.5*(1-am(e,t/3,t)),flatten:(e,t)=>am(e,2*t,4*t)};function sm(e,t,n){let r=t.map(t=>om[e](t,n));return r.length>0&&e===`enhance`&&(r[0]=r.length>1?rm:im),r.length>0&&e!==`enhance`&&(r[0]=0),r.length>2&&e===`enhance`&&(r[1]=Math.max(r[1],im)),r.map(e=>Math.round(1e3*e)/1e3)}function cm(e,t){return e.map((e,n)=>{let r=t[n]>0?e/t[n]:1;return Math.round(1e3*Math.min(4,r))/1e3})}function lm(t){let{region:n}=t;return!n||!(`painted`in n)?null:[`smooth`,`enhance`,`flatten`,`match`].find(n=>t.name===e.effects[n])??null}var um=500,dm=9,fm=4,pm=class{studio;canvas;pointers=new Map;stroke=null;hovering=!1;hoverNext=null;turning=null;moved=0;looking=0;pinch={distance:0,angle:0,x:0,y:0};hoverAnswer=null;pendingPress=null;grabbing=null;grab;onClick=null;constructor(e,t){this.studio=e,this.canvas=t,this.grab=new Se(e),t.addEventListener(`pointerdown`,e=>this.onPointerDown(e)),t.addEventListener(`pointermove`,e=>this.onPointerMove(e)),t.addEventListener(`pointerup`,e=>this.onPointerUp(e)),t.addEventListener(`pointercancel`,e=>this.onPointerUp(e)),t.addEventListener(`pointerleave`,()=>this.onPointerLeave()),t.addEventListener(`contextmenu`,e=>e.preventDefault()),t.addEventListener(`dblclick`,e=>void this.setPivot(e)),t.addEventListener(`wheel`,e=>this.onWheel(e),{passive:!1}),e.on(`tool`,()=>{!e.isBrushOn&&!e.isGrabOn&&e.view.showRing(null,null),t.classList.toggle(`brushing`,e.isBrushOn),t.classList.toggle(`grabbing`,e.isGrabOn)})}canvasPoint(e){let t=this.canvas.getBoundingClientRect();return{x:e.clientX-t.left,y:e.clientY-t.top}}onPointerDown(e){if(!this.studio.shape)return;this.canvas.focus({preventScroll:!0}),this.canvas.setPointerCapture(e.pointerId);let t=this.canvasPoint(e);if(this.pointers.set(e.pointerId,t),this.moved=0,this.pointers.size===2){this.pendingPress=null,this.stroke&&this.endStroke(`drop`),this.endGrab(`drop`),this.turning=null,this.startPinch();return}let n=e.button===1||e.button===2||e.shiftKey;if(this.studio.view.placeInHalf(t).isSecond){this.turning=n?`pan`:`turn`,this.moved=fm;return}let r=this.studio.isBrushOn&&U.effect===`clone`;if(r&&!n&&!this.studio.onPickVertex&&(e.altKey||this.studio.cloneSource===null)&&this.studio.pickCloneSource(),(this.studio.isGrabOn||r)&&!n&&e.button===0&&!this.studio.onPickVertex){this.endGrab(`drop`);let n={hit:null,began:!1,at:t,moved:0,released:!1};this.grabbing={pointer:e.pointerId,handle:-1,...n},this.beginGrab(this.grabbing,t)}else if(!this.studio.isBrushOn||U.effect!==`match`||!e.altKey&&this.studio.detail.isPicked||n||this.studio.onPickVertex||this.studio.detail.startPick(),this.studio.isBrushOn&&!n&&e.button===0&&!this.studio.onPickVertex){let n=e.pointerType===`pen`&&e.pressure>0?.3+.7*e.pressure:1;this.pendingPress={id:e.pointerId,...t,invert:e.ctrlKey||e.metaKey,pressure:n},this.resolvePress(this.pendingPress)}else this.turning=n?`pan`:`turn`}async beginGrab(e,{x:t,y:n}){let{studio:r}=this,i=this.grabMode;e.handle=i===`pull`?this.grab.handleAt(t,n):-1;let a=r.view.camera.ray(t,n),{hit:o}=await r.engine.call(`pick`,{ray:a,ring:null});if(this.grabbing===e){if(!o&&e.handle<0)this.grabbing=null,this.pointers.has(e.pointer)&&(this.turning=`turn`);else{if(e.hit=o,i!==`pull`&&o)this.grab.beginStroke(i),e.began=!0,this.grab.touch(o.vertex);else if(!e.released||e.moved>=fm){if(e.began=await this.grab.begin(e.handle,o,t,n),this.grabbing!==e){e.began&&this.grab.end(`drop`);return}if(!e.began){this.grabbing=null;return}e.moved>=fm&&this.grab.moveTo(e.at.x,e.at.y)}e.released&&this.endGrab(`keep`)}}}get grabMode(){return this.studio.isGrabOn?fe.mode:`clone`}touchOnce(e,t){this.grab.beginStroke(t),this.grab.touch(e),this.grab.end(`keep`)}moveGrab(e){let{grabbing:t,studio:n}=this;if(!t?.began)return;if(this.grabMode===`pull`){t.moved>=fm&&this.grab.moveTo(e.x,e.y);return}let r=n.view.camera.ray(e.x,e.y);n.engine.call(`pick`,{ray:r,ring:null}).then(({hit:e})=>{e&&this.grabbing===t&&this.grab.touch(e.vertex)})}endGrab(e){let{grabbing:t}=this;if(!t)return;let n=this.grabMode===`pull`&&t.moved<fm;e===`keep`&&!t.began&&!(n&&t.hit)?t.released=!0:(this.grabbing=null,this.grab.end(n?`drop`:e),n&&e===`keep`&&t.handle<0&&t.hit&&this.touchOnce(t.hit.vertex,`pin`))}interrupt(){this.endGrab(this.grabbing?.began?`keep`:`drop`)}async resolvePress(e){let{studio:t}=this,n=Ae(t,e.pressure,e.invert),r=t.view.camera.ray(e.x,e.y),i=await t.engine.call(`pick`,{ray:r,ring:null});if(this.pendingPress!==e)return;if(this.pendingPress=null,!i.hit){this.pointers.has(e.id)&&(this.turning=`turn`);return}if(!await this.chooseLayer(i.hit,n))return;try{await t.showMask(t.layer,n.mode===`smooth`?Me(n):null)}catch(e){t.history.cancel(),t.showMessage(e.message,`error`);return}let a=t.view.camera.project(i.hit.point).scale;this.stroke={pointer:e.id,key:t.layer.key,shape:n,x:e.x,y:e.y,spacing:Math.max(2,De*n.radius*a),rays:[r],busy:!1,ended:this.pointers.has(e.id)?null:`keep`,stamped:0},this.paint()}async chooseLayer(t,n){let{studio:r}=this,{effect:i}=U;if(i===`region`)return r.layer.region||(r.addLayer(e.layerName(r.layers.length+1),{painted:[]},!1),r.showMessage(e.paintedLayer)),!0;if(i===`clone`)return!1;if(lm(r.layer)===i)return!0;let a=r.layers.findLast(e=>lm(e)===i);if(a&&i!==`match`)return r.select(a.key),!0;if(n.mode!==`add`)return r.showMessage(e.nothingToErase),!1;let o=r.doc.levels.sigmas,s=i===`match`?await r.detail.gainsAt(t.vertex,n.radius):sm(i,o,n.radius);return s?(r.addLayer(e.effects[i],{painted:[]},!1,s),!0):(r.showMessage(e.noDetail),!1)}async paint(){let{stroke:e,studio:t}=this;if(!e||e.busy)return;if(e.rays.length===0){e.ended&&await this.commitStroke(e);return}e.busy=!0;let n=e.rays.splice(0);try{let r=await t.engine.call(`paint`,{key:e.key,rays:n,brush:e.shape,ring:je(e.shape)});e.stamped+=r.stamped,r.stamped&&t.timings.records.stamp.push(r.stampTook),t.view.showRing(r.outer,r.inner),t.showSpectrum(r.spectrum),r.stamped&&(t.view.markMoving(),t.display.showTarget(!1))}catch(n){t.showMessage(n.message,`error`),e.ended=`drop`}e.busy=!1,this.paint()}endStroke(e){this.stroke&&(this.stroke.ended=e,e===`drop`&&(this.stroke.rays=[]),this.paint())}async commitStroke(e){let{studio:t}=this;this.stroke=null;let n=e.ended===`keep`&&e.stamped>0,r=t.findLayer(e.key),i=r?Pe(r.region,[],e.shape):null,a=i?t.regions.id(i):-1,{indices:o}=await t.engine.call(`paintEnd`,{key:e.key,keep:n&&i!==null,child:a,brush:e.shape});!n||!i?(t.history.cancel(),t.display.showTarget(!0)):(Fe(i).push(...o),r?.region&&t.regions.registerStroke(i,r.region),t.changeLayer({region:i},!1,e.key),t.history.end())}onPointerMove(e){let t=this.canvasPoint(e),n=this.pointers.get(e.pointerId);if(!n){this.hover(t);return}let r=t.x-n.x,i=t.y-n.y;this.moved+=Math.abs(r)+Math.abs(i),this.pointers.set(e.pointerId,t);let{camera:a}=this.studio.view;if(this.pointers.size===2)this.movePinch();else if(this.grabbing?.pointer===e.pointerId){this.grabbing.at=t,this.grabbing.moved+=Math.abs(r)+Math.abs(i),this.moveGrab(t);return}else if(this.stroke?.pointer===e.pointerId){let t=e.getCoalescedEvents?.()??[];for(let n of t.length?t:[e])this.addRays(this.canvasPoint(n));this.paint();return}else if(this.turning===`turn`)a.turn(r,i);else if(this.turning===`pan`)a.pan(r,i);else return;this.studio.view.markMoving()}addRays(e){let t=this.stroke,n=Math.hypot(e.x-t.x,e.y-t.y);for(;n>=t.spacing;){let r=t.spacing/n;t.x+=(e.x-t.x)*r,t.y+=(e.y-t.y)*r,t.rays.push(this.studio.view.camera.ray(t.x,t.y)),n=Math.hypot(e.x-t.x,e.y-t.y)}}onPointerUp(e){if(!this.pointers.delete(e.pointerId))return;if(this.grabbing?.pointer===e.pointerId){this.endGrab(e.type===`pointercancel`?`drop`:`keep`);return}if(this.stroke?.pointer===e.pointerId){this.endStroke(e.type===`pointercancel`?`drop`:`keep`);return}let t=this.moved<fm&&this.turning===`turn`&&e.button===0;this.turning=this.pointers.size===0?null:`turn`,t&&this.click(this.canvasPoint(e))}async vertexAt(e,t){let{engine:n,view:r}=this.studio,{hit:i}=await n.call(`pick`,{ray:r.camera.ray(e,t),ring:null});return i?.vertex??null}async click(t){let{studio:n}=this,r=n.view.camera.ray(t.x,t.y),i=await n.engine.call(`pick`,{ray:r,ring:null});if(i.hit&&(n.lastVertex=i.hit.vertex),n.onPickVertex){if(!i.hit){n.requestVertex(e.missed,n.onPickVertex);return}let t=n.onPickVertex;n.onPickVertex=null,t(i.hit.vertex)}else this.onClick?.(i,t.x,t.y)}escape(){return this.studio.cancelPick()?!0:this.grabbing?(this.endGrab(`drop`),!0):this.stroke?(this.endStroke(`drop`),!0):!1}hover(e){this.studio.view.placeInHalf(e).isSecond?this.onPointerLeave():(this.hoverNext=e,!this.hovering&&this.studio.shape&&(this.hovering=!0,this.hoverLoop().finally(()=>{this.hovering=!1})))}async hoverLoop(){let{studio:e}=this;for(;this.hoverNext;){let t=this.hoverNext;this.hoverNext=null;let n=Ae(e,1,!1),r=e.isBrushOn||e.isGrabOn&&fe.mode!==`pull`,i=r?{radius:n.radius,half:je(n)}:null,a=await e.engine.call(`pick`,{ray:e.view.camera.ray(t.x,t.y),ring:i});if(e.timings.records.pick.push(a.took),this.hoverAnswer=a,r&&!this.stroke){let{hit:t,outer:r}=a,i=t&&!r?this.flatRing(t,n.radius):null;e.view.showRing(r??i,a.inner),e.view.showRing(a.outer??i,a.inner),e.view.markMoving()}e.showSpectrum(a.spectrum),await new Promise(e=>requestAnimationFrame(e))}}flatRing(e,t){let n=this.studio.shape?.graph;return n?n.flat?nm({...e,normal:[0,0,1]},t):null:nm(e,t)}onPointerLeave(){this.hoverNext=null,this.hoverAnswer=null,this.stroke||this.studio.view.showRing(null,null)}get hovered(){return this.hoverAnswer}onWheel(e){e.preventDefault();let{x:t,y:n}=this.studio.view.placeInHalf(this.canvasPoint(e)),r=e.deltaMode===1?16:1;if(this.studio.isBrushOn&&e.altKey){this.resizeBrush(e.deltaY>0?1/1.1:1.1);return}let{hit:i}=this.hoverAnswer??{hit:null};i&&this.studio.view.camera.focusDepth(i.point),this.studio.view.camera.zoom(Math.exp(Math.max(-60,Math.min(60,e.deltaY*r))*.0025),t,n),this.studio.view.markMoving(),window.clearTimeout(this.looking),this.looking=window.setTimeout(()=>void this.findShape(),um)}async findShape(){let{studio:t}=this;if(!t.shape||this.hoverAnswer?.hit)return;let{camera:n}=t.view,{width:r,height:i}=t.view.part;for(let e=0;e<dm**2;e++){let t=(e%dm+.5)*(r/dm),n=(Math.floor(e/dm)+.5)*(i/dm);if(await this.vertexAt(t,n)!==null)return}let a=t.showMessage(e.nothingSeen,`info`,{label:e.frame,onclick:()=>{n.frame(),t.view.markMoving()}});t.view.afterNextMove(a)}resizeBrush(e){U.radius=Math.round(2*Math.min(30,Math.max(.5,U.radius*e+(e>1?.25:-.25))))/2,this.studio.emit(`tool`)}async setPivot(e){let{x:t,y:n,isSecond:r}=this.studio.view.placeInHalf(this.canvasPoint(e));if(r)return;let i=await this.studio.engine.call(`pick`,{ray:this.studio.view.camera.ray(t,n),ring:null});i.hit&&(this.studio.view.camera.setPivot(i.hit.point),this.studio.view.markMoving())}startPinch(){let[e,t]=[...this.pointers.values()];this.pinch={distance:Math.hypot(e.x-t.x,e.y-t.y),angle:Math.atan2(t.y-e.y,t.x-e.x),x:(e.x+t.x)/2,y:(e.y+t.y)/2}}movePinch(){let{camera:e}=this.studio.view,t=this.pinch;this.startPinch();let n=this.pinch;t.distance>0&&n.distance>0&&e.zoom(t.distance/n.distance,n.x,n.y),this.studio.isBrushOn?e.turn(n.x-t.x,n.y-t.y):e.pan(n.x-t.x,n.y-t.y),e.roll(n.angle-t.angle)}},mm=class{studio;pickedRms=null;constructor(e){this.studio=e}get isPicked(){return this.pickedRms?.length===this.studio.nLevels}startPick(){let{studio:t}=this;t.requestVertex(e.pickDetailClick,e=>this.pickFrom(e,U.radius/100*t.shape.diagonal))}pickFrom(t,n){this.studio.engine.call(`energy`,{key:null,vertex:t,radius:n}).then(({rms:t})=>{this.pickedRms=t,this.studio.showMessage(e.detailPicked)})}async gainsAt(e,t){let{pickedRms:n,studio:r}=this;if(!n||n.length!==r.nLevels)return null;let{rms:i}=await r.engine.call(`energy`,{key:null,vertex:e,radius:t});return cm(n,i)}},hm={step:30,move:120},gm=new Uint8Array,_m=class{studio;masks;settling=!1;settleAgain=!1;restTimer=0;waiters=[];shownDoc=null;pulling=!1;pullAgain=!1;pulledAt=0;drawn=null;problem=null;withdrawProblem=()=>{};constructor(e,t){this.studio=e,this.masks=t;let{view:n,timings:r}=e;n.onDrawn=e=>r.recordFrame(e,this.isCurrent,()=>n.finish())}show(e){let{view:t}=this.studio;this.studio.isPulling?(this.pulledAt||=performance.now(),this.pull()):t.arrays.large&&this.showLive()?(e&&t.draw(),window.clearTimeout(this.restTimer),this.restTimer=window.setTimeout(()=>this.settle(),e?hm.step:hm.move)):this.settle()}async pull(){let{studio:e}=this,{view:t,doc:n,timings:r}=e,i=I(n);if(!t.arrays.large||!i){this.settle();return}if(this.pulling){this.pullAgain=!0;return}this.pulling=!0;let{generation:a}=e.session,o=this.pulledAt;this.pulledAt=0;try{let{drawn:s}=t.arrays;s&&s!==this.drawn&&(await e.engine.call(`drawn`,{vertices:s.slice()}),this.drawn=s);let c=await e.engine.call(`bend`,{by:i,follow:`step`,drawn:s!==null});if(a===e.session.generation&&e.isPulling){t.arrays.setPosed(i,c),t.markMoving();let a=t.arrays.pulledBy(c);a&&(e.displacement={...a,volume:null}),e.emit(`moved`);let s=this.showLive(i);!s&&t.showPulled(c)&&(this.shownDoc=n,s=!0),s?(t.draw(),o&&r.isEnabled&&(t.finish(),r.records.pull.push(performance.now()-o))):this.settle()}}catch(t){e.showMessage(t.message,`error`)}finally{this.pulling=!1}this.pullAgain&&(this.pullAgain=!1,e.isPulling&&this.pull())}showLive(e=I(this.studio.doc)){let{doc:t,nLevels:n,view:r}=this.studio;if(!ie(r.arrays.by,e))return!1;let i=j(t.layers,this.positionSolo).filter(e=>e.on),a=i.map(e=>({opacity:e.opacity,gains:e.gains,mask:e.region?gm:null})),o=i.filter(e=>e.region).map(e=>({slot:this.masks.slot(e.key),slopes:e.gains.map(t=>e.opacity*(t-1))}));if(!i.every(e=>!e.region||this.masks.has(e.key)))return!1;let s=r.setGains(Wd(a,n),o);return s&&(this.shownDoc=t),s}showTarget(e){this.studio.target===null?this.show(e):this.studio.fieldEditor.show()}get isCurrent(){return this.shownDoc===this.studio.doc}markShown(e){e===this.studio.doc&&(this.shownDoc=e)}settle(){window.clearTimeout(this.restTimer),this.restTimer=0,this.settling?this.settleAgain=!0:this.studio.shape&&(this.settling=!0,this.compute().finally(()=>{if(this.settling=!1,this.settleAgain)this.settleAgain=!1,this.settle();else if(!this.restTimer)for(let e of this.waiters.splice(0))e()}))}waitUntilSettled(){return!this.settling&&!this.restTimer?Promise.resolve():new Promise(e=>this.waiters.push(e))}async compute(){let{studio:e}=this,{doc:t,saver:n,regions:r,view:i}=e,{generation:a}=e.session,o=()=>a!==e.session.generation,{updates:s,ids:c}=r.updatesFor(t.layers.map(e=>e.region)),l=this.positionSolo,u=j(t.layers,l).map((e,t)=>({key:e.key,on:e.on,opacity:e.opacity,gains:e.gains,region:c[t]})),d=!l&&oe(t,e.shape)&&n?.state===`saved`&&!n.hasUnsavedStep;try{let n=e.isPulling?`step`:`rest`,r=this.pulledAt;this.pulledAt=0;let a=I(t),c=e.keptKeys(t),f=await e.engine.call(`edit`,{layers:u,regions:s,keep:c,exact:d,by:a,follow:n});if(o())return;this.masks.retainLayers(c),f.places&&f.turns?i.arrays.setPosed(a,{places:f.places,turns:f.turns}):a?i.arrays.by&&!f.problem&&(i.arrays.by=a):i.arrays.setPosed(null,null),e.timings.records.settle.push(f.took),f.problem!==this.problem&&this.withdrawProblem(),f.problem&&f.problem!==this.problem&&(this.withdrawProblem=e.showMessage(f.problem,`error`)),this.problem=f.problem,t!==e.doc&&i.arrays.large||(i.arrays.setEdited(f.positions,f.normals),this.shownDoc=t),r&&e.isPulling&&e.timings.isEnabled&&(i.draw(),i.finish(),e.timings.records.pull.push(performance.now()-r)),t===e.doc&&!l&&this.updateDisplacement(f)}catch(t){r.markUnknown(s),o()||e.showMessage(t.message,`error`)}}get positionSolo(){return this.studio.target===null?this.studio.solo:null}updateDisplacement({greatest:e,rms:t,volume:n}){let{studio:r}=this,i=r.turnedParts.volume;r.view.camera.setReach(r.doc.pose?e:0),r.displacement={greatest:e,rms:t,volume:i!==null&&n!==null?[i,n]:null},r.emit(`moved`)}},vm=class{onEvent;worker;pendingCalls=new Map;lastId=0;constructor(e,t){this.onEvent=t,this.worker=e,e.onmessage=e=>{let t=e.data;if(`event`in t){this.onEvent(t);return}let n=this.pendingCalls.get(t.id);this.pendingCalls.delete(t.id),`error`in t?n?.failed(Error(t.error)):n?.done(t.answer)},e.onerror=e=>{for(let{failed:t}of this.pendingCalls.values())t(Error(e.message));this.pendingCalls.clear()}}call(e,t,n=[]){let r=++this.lastId;return new Promise((i,a)=>{this.pendingCalls.set(r,{done:i,failed:a}),this.worker.postMessage({id:r,call:e,with:t},n)})}},ym=class{studio;loaded=null;before=null;values=null;change=null;isComputing=!1;computeAgain=!1;waiters=[];turn=0;hasGaps=!1;problem=null;constructor(e){this.studio=e}async load(t){let{studio:n}=this,r=++this.turn,i=()=>r!==this.turn;this.forget();let{id:a}=n.shape,o=await n.wait(e.computingField(t),e=>n.api.fieldBands(a,t,e)).catch(e=>{if(i())return null;throw e});if(i())return!0;if(!o)return!1;if(this.before=o.slice(0,n.shape.n_vertices),this.hasGaps=this.before.some(e=>Number.isNaN(e)),await n.engine.call(`field`,{values:o},[o.buffer]),i())return n.target===null&&n.engine.call(`field`,{values:null}),!0;this.loaded=t,n.emit(`band`),this.show(),this.refine().catch(()=>{});let s=this.before.reduce((e,t)=>e+Number(Number.isNaN(t)),0),c=n.shape.graph&&t===`degree`;return Tp(this.before)&&!c?n.showMessage(e.fieldOfClasses(t)):s>0&&n.showMessage(e.fieldWithGaps(t,we(s))),!0}drop(){let e=this.loaded!==null;this.close(),e&&this.studio.engine.call(`field`,{values:null})}close(){this.turn++,this.forget()}forget(){this.loaded=null,this.before=null,this.values=null,this.change=null,this.studio.emit(`fieldEdited`)}show(){this.loaded!==null&&(this.isComputing?this.computeAgain=!0:(this.isComputing=!0,this.compute().finally(()=>{if(this.isComputing=!1,this.computeAgain)this.computeAgain=!1,this.show();else for(let e of this.waiters.splice(0))e()})))}waitUntilShown(){return this.isComputing?new Promise(e=>this.waiters.push(e)):Promise.resolve()}async compute(){let{studio:e,turn:t}=this,{doc:n,regions:r,solo:i}=e,a=le(n,e.target??``)?j(e.layers,i):[],{updates:o,ids:s}=r.updatesFor(a.map(e=>e.region)),c=a.map(({key:e,on:t,opacity:n,gains:r},i)=>({key:e,on:t,opacity:n,gains:r,region:s[i]}));try{let r=e.keptKeys(n),i=await e.engine.call(`fieldEdit`,{layers:c,regions:o,keep:r});if(t!==this.turn)return;e.masks.retainLayers(r),i.problem&&i.problem!==this.problem&&e.showMessage(i.problem,`error`),this.problem=i.problem,this.take(i,n)}catch(n){r.markUnknown(o),t===this.turn&&e.showMessage(n.message,`error`)}}take({values:e,greatest:t,rms:n},r){this.values=e,this.studio.solo||(this.change={greatest:t,rms:n}),this.studio.shapeDisplay.markShown(r),this.studio.emit(`fieldEdited`)}async refine(){let{studio:e,loaded:t,turn:n}=this,{doc:r,layers:i,saver:a,shape:o}=e;if(t===null||!this.hasGaps||e.solo||!o||!i.some(e=>e.region&&!L([e]))||a?.state!==`saved`||a.hasUnsavedStep)return;await this.waitUntilShown();let s=await e.api.editedField(o.id,t);n===this.turn&&S(r,t)===S(e.doc,t)&&(this.values=s,e.emit(`fieldEdited`))}};function bm(e){return w(e).map(e=>e.key)}var xm=[`gray`,`map`,`relief`,`color`];function Sm(e){return xm.some(t=>t===e)}var Cm=new Uint32Array(Dp(`viridis`).buffer),wm=Uint32Array.from({length:256},(e,t)=>(4278190080|t<<16|t<<8|t)>>>0);function Tm(e,t,n){let r=new Uint32Array(n.buffer,n.byteOffset,n.byteLength/4);t.mode===`relief`?Om(e,t,r):t.mode===`color`&&e.nChannels>=3?Dm(e,t,r):Em(e,t,r)}function Em({values:e,nChannels:t},{window:n,mode:r},i){let a=r===`map`?Cm:wm,[o,s]=n,c=255/(s-o);for(let n=0;n<i.length;n++){let r=(e[n*t]-o)*c+.5;i[n]=r>=255?a[255]:r<=0?a[0]:r>0?a[r|0]:0}}function Dm({values:e,nChannels:t},{window:[n,r],opacity:i},a){let o=255/(r-n),s=e=>e>=255?255:e>0?e+.5|0:0;for(let r=0,c=0;r<a.length;r++,c+=t){let l=e[c];if(Number.isNaN(l)){a[r]=0;continue}let u=i?s(255*e[c+t-1]/i.full):255,d=e[c+1],f=e[c+2];a[r]=(u<<24|s((f-n)*o)<<16|s((d-n)*o)<<8|s((l-n)*o))>>>0}}function Om({values:e,rows:t,columns:n,nChannels:r},{spacings:i,height:a},o){let[s,c]=[a/(8*i[0]),a/(8*i[1])],l=(e,t)=>Number.isNaN(e)?t:e;for(let i=0;i<t;i++){let a=i*n,u=Math.max(0,i-1)*n,d=Math.min(t-1,i+1)*n;for(let t=0;t<n;t++){let i=e[(a+t)*r];if(Number.isNaN(i)){o[a+t]=0;continue}let f=t>0?t-1:0,p=t+1<n?t+1:t,m=e[(u+f)*r],h=e[(u+t)*r],g=e[(u+p)*r],_=e[(a+f)*r],v=e[(a+p)*r],y=e[(d+f)*r],b=e[(d+t)*r],x=e[(d+p)*r];Number.isNaN(m+h+g+_+v+y+b+x)&&([m,h,g]=[l(m,i),l(h,i),l(g,i)],[_,v]=[l(_,i),l(v,i)],[y,b,x]=[l(y,i),l(b,i),l(x,i)]);let S=(g+2*v+x-m-2*_-y)*c,C=(y+2*b+x-m-2*h-g)*s,w=(.5*(S+C)+Math.SQRT1_2)/Math.sqrt(1+S*S+C*C);o[a+t]=wm[w<=0?0:w>=1?255:255*w+.5|0]}}}function km({values:e,rows:t,columns:n,nChannels:r},i){let a=Math.max(1,Math.floor(Math.sqrt(t*n/4e4))),o=0,s=0;for(let c=0;c+1<t;c+=a)for(let t=0;t+1<n;t+=a){let a=(c*n+t)*r,l=(e[a+r]-e[a])/i[1],u=(e[a+n*r]-e[a])/i[0],d=l*l+u*u;Number.isNaN(d)||(o+=d,s++)}return o>0?.4/Math.sqrt(o/s):1}var Am=`adwave-grids`;function jm(){try{let e=JSON.parse(localStorage.getItem(Am)??`[]`);return Array.isArray(e)?e:[]}catch{return[]}}function Mm(e){return`${e.name} ${e.grid.sizes.join(`×`)}`}function Nm(e,t){let n=jm().filter(([t])=>t!==Mm(e));try{localStorage.setItem(Am,JSON.stringify([...n.slice(-39),[Mm(e),t]]))}catch{}}function Pm(e){let t=jm().find(([t])=>t===Mm(e))?.[1];return t&&Fm(t,e.grid.sizes)?t:null}function Fm({look:e,cross:t,frame:n,panes:r},i){let a=(e,t)=>Array.isArray(e)&&e.length===t&&e.every(e=>Number.isFinite(e));return Sm(e?.mode)&&a(e.window,2)&&e.window[0]<e.window[1]&&e.relief>0&&a(t,i.length)&&Number.isInteger(n)&&n>=0&&Array.isArray(r)&&r.every(e=>e?.zoom>0&&Number.isFinite(e.zoom)&&a(e.middle,2))}var Im=64,Lm=12,Rm=4,zm=class{view;dragMoves;events;element;canvas;sizes;plane=null;ratio=null;context;picture=document.createElement(`canvas`);before=document.createElement(`canvas`);zoom=1;middle;pointers=new Map;spacings;constructor(e,t,r,i,a){this.view=t,this.dragMoves=i,this.events=a;let[o,s]=t.axes;this.sizes=[e.sizes[o],e.sizes[s]],this.spacings=[e.spacings[o],e.spacings[s]],this.middle=[(this.sizes[0]-1)/2,(this.sizes[1]-1)/2],this.canvas=n(`canvas`,{tabIndex:0,"aria-label":r,role:`img`});let[c,l,u,d]=t.edges,f=t.edges.every(e=>e)?[n(`span`,{class:`edge left`},c),n(`span`,{class:`edge right`},l),n(`span`,{class:`edge low`},u),n(`span`,{class:`edge up`},d)]:[];this.element=n(`div`,{class:`pane`},this.canvas,...f),this.context=this.canvas.getContext(`2d`,{willReadFrequently:!0}),this.listen()}get fit(){let{clientWidth:e,clientHeight:t}=this.canvas;return(this.dragMoves?.94:.9)*Math.min(e/(this.sizes[1]*this.spacings[1]),t/(this.sizes[0]*this.spacings[0]))}get pitch(){let e=this.fit*this.zoom,[t,n]=this.view.flips;return[(t?-1:1)*e*this.spacings[0],(n?-1:1)*e*this.spacings[1]]}toScreen([e,t]){let[n,r]=this.pitch,{clientWidth:i,clientHeight:a}=this.canvas;return[i/2+(t-this.middle[1])*r,a/2+(e-this.middle[0])*n]}toIndices(e,t){let[n,r]=this.pitch,{clientWidth:i,clientHeight:a}=this.canvas;return[this.middle[0]+(t-a/2)/n,this.middle[1]+(e-i/2)/r]}get seen(){let e=this.toIndices(0,0),t=this.toIndices(this.canvas.clientWidth,this.canvas.clientHeight),n=this.ratio??(window.devicePixelRatio||1);return{low:[Math.min(e[0],t[0]),Math.min(e[1],t[1])],high:[Math.max(e[0],t[0]),Math.max(e[1],t[1])],perPixel:1/(n*Math.max(...this.pitch.map(Math.abs)))}}enlarge(e,t=this.canvas.clientWidth/2,n=this.canvas.clientHeight/2){let r=this.toIndices(t,n),i=Im/(this.fit*Math.min(...this.spacings));this.zoom=Math.min(Math.max(1,i),Math.max(.5,this.zoom*e));let a=this.toIndices(t,n);this.middle=[this.middle[0]+r[0]-a[0],this.middle[1]+r[1]-a[1]],this.keepInside(),this.events.moved()}move(e,t){let[n,r]=this.pitch;this.middle=[this.middle[0]-t/n,this.middle[1]-e/r],this.keepInside(),this.events.moved()}fitAll(){this.zoom=1,this.middle=[(this.sizes[0]-1)/2,(this.sizes[1]-1)/2],this.events.moved()}keepInside(){let e=(e,t)=>Math.min(t-1,Math.max(0,e));this.middle=[e(this.middle[0],this.sizes[0]),e(this.middle[1],this.sizes[1])]}get place(){return{zoom:this.zoom,middle:[...this.middle]}}set place({zoom:e,middle:t}){this.zoom=Math.max(.5,e),this.middle=[...t],this.keepInside()}paint(e,t,n=!1){let{plane:r}=this,i=n?this.before:this.picture;if(!r)return;let{rows:a,columns:o,nChannels:s}=r;(i.width!==o||i.height!==a)&&(i.width=o,i.height=a);let c=new ImageData(o,a),l=t?r.values:r.edited,[u,d]=e.spacings,{step:f}=r.part;Tm({values:l,rows:a,columns:o,nChannels:s},{...e,spacings:[u*f,d*f]},c.data),i.getContext(`2d`,{willReadFrequently:!0}).putImageData(c,0,0)}draw(e){let{canvas:t,context:n,plane:r,picture:i}=this,a=this.ratio??(window.devicePixelRatio||1),[o,s]=[Math.max(1,Math.round(t.clientWidth*a)),Math.max(1,Math.round(t.clientHeight*a))];if((t.width!==o||t.height!==s)&&(t.width=o,t.height=s),n.setTransform(1,0,0,1,0,0),n.clearRect(0,0,o,s),r){let{from:t,step:o}=r.part,[s,c]=this.pitch,[l,u]=this.toScreen([t[0]-.5,t[1]-.5]);e.hasGaps&&this.drawStripes(a,e.muted),n.setTransform(a*c*o,0,0,a*s*o,a*l,a*u),n.imageSmoothingEnabled=e.smooth,n.imageSmoothingQuality=`high`,n.drawImage(i,0,0),e.wipe!==null&&e.wipe>0&&this.drawBefore(e.wipe*a)}e.cross&&this.drawCross(e.cross,a,e.ink)}drawBefore(e){let{context:t,before:n}=this,r=t.getTransform();t.save(),t.setTransform(1,0,0,1,0,0),t.beginPath(),t.rect(0,0,e,this.canvas.height),t.clip(),t.clearRect(0,0,e,this.canvas.height),t.setTransform(r),t.drawImage(n,0,0),t.restore()}drawStripes(e,t){let{context:n,sizes:r}=this,i=this.toScreen([-.5,-.5]),a=this.toScreen([r[0]-.5,r[1]-.5]),[o,s]=[Math.min(i[0],a[0]),Math.min(i[1],a[1])],[c,l]=[Math.abs(i[0]-a[0]),Math.abs(i[1]-a[1])];n.save(),n.setTransform(e,0,0,e,0,0),n.beginPath(),n.rect(o,s,c,l),n.clip(),n.beginPath();let{clientWidth:u,clientHeight:d}=this.canvas;for(let e=-d;e<u;e+=Lm)n.moveTo(e,0),n.lineTo(e+d,d);n.strokeStyle=t,n.lineWidth=1,n.stroke(),n.restore()}drawCross(e,t,n){let{context:r,canvas:i}=this,[a,o]=this.toScreen(e);r.setTransform(t,0,0,t,0,0),r.strokeStyle=n,r.lineWidth=1;let s=this.dragMoves?4:6,c=this.dragMoves?12:Math.max(i.clientWidth,i.clientHeight);r.beginPath();for(let[e,t]of[[1,0],[-1,0],[0,1],[0,-1]])r.moveTo(a+s*e,o+s*t),r.lineTo(a+c*e,o+c*t);r.stroke()}listen(){let{canvas:e,pointers:t,events:n}=this,r=t=>{let{left:n,top:r}=e.getBoundingClientRect();return[t.clientX-n,t.clientY-r]},i=!1,a=0;e.addEventListener(`pointerdown`,o=>{o.button>2||(e.setPointerCapture(o.pointerId),t.set(o.pointerId,r(o)),t.size===1&&(a=0),i=this.dragMoves||o.button!==0||o.shiftKey||t.size>1,i||n.point(this.toIndices(...r(o)),`press`))}),e.addEventListener(`pointermove`,e=>{let[o,s]=r(e),c=t.get(e.pointerId);if(!c)n.point(this.toIndices(o,s),`hover`);else{if(a+=Math.abs(o-c[0])+Math.abs(s-c[1]),t.size===2){let n=[...t].find(([t])=>t!==e.pointerId)[1],r=([e,t])=>Math.hypot(e-n[0],t-n[1])||1;this.enlarge(r([o,s])/r(c),(o+n[0])/2,(s+n[1])/2),this.move((o-c[0])/2,(s-c[1])/2)}else i?this.move(o-c[0],s-c[1]):n.point(this.toIndices(o,s),`drag`);t.set(e.pointerId,[o,s])}});let o=e=>{!t.delete(e.pointerId)||t.size>0||i&&a<Rm&&e.type===`pointerup`&&n.point(this.toIndices(...r(e)),`click`)};e.addEventListener(`pointerup`,o),e.addEventListener(`pointercancel`,o),e.addEventListener(`pointerleave`,()=>n.leave()),e.addEventListener(`contextmenu`,e=>e.preventDefault()),e.addEventListener(`dblclick`,()=>this.fitAll()),e.addEventListener(`wheel`,e=>{e.preventDefault(),this.dragMoves||e.ctrlKey?this.enlarge(Math.exp(-e.deltaY/400),...r(e)):n.slice(e.deltaY>0?-1:1)},{passive:!1})}},Bm=.02;function Vm(t){let r=null,i=n(`div`,{class:`divider`,hidden:!0,role:`slider`,tabIndex:0,"aria-label":e.split,"aria-valuemin":`0`,"aria-valuemax":`100`},n(`span`,{},e.beforeShort),n(`span`,{},e.afterShort)),a=e=>{r=e===null?null:Math.min(.98,Math.max(Bm,e)),i.hidden=r===null,r!==null&&(i.style.left=`${100*r}%`,i.setAttribute(`aria-valuenow`,String(Math.round(100*r)))),t()};return i.addEventListener(`pointerdown`,e=>i.setPointerCapture(e.pointerId)),i.addEventListener(`pointermove`,e=>{if(!i.hasPointerCapture(e.pointerId))return;let{left:t,width:n}=i.parentElement.getBoundingClientRect();a((e.clientX-t)/n)}),i.addEventListener(`keydown`,e=>{let t={ArrowLeft:-.02,ArrowRight:.02,PageDown:-.1,PageUp:.1}[e.key];t!==void 0&&(e.preventDefault(),e.stopPropagation(),a((r??.5)+t))}),{divider:i,get at(){return r},toggle:()=>a(r===null?.5:null)}}var Hm=1<<20,Um={u8:255,u16:65535},Wm=class{studio;element=n(`div`,{class:`grid-panes`,hidden:!0});look={mode:`gray`,window:[0,1],relief:1,smooth:!1};cross=[];hovered=null;grid=null;panes=[];shownFrame=0;drawRequest=0;usualHeight=1;hasMark=!1;waiters=[];shownDoc=null;content=0;listeners=[];wipe=Vm(()=>this.request());frames=Ke(({frame:e})=>this.showFrame(e));constructor(e){this.studio=e,new ResizeObserver(()=>this.request()).observe(this.element),e.on(`before`,()=>this.request()),e.on(`theme`,()=>this.request()),e.on(`shape`,()=>{e.isGrid||this.frames.set([],0)})}onPlace(e){this.listeners.push(e)}get id(){return this.studio.shape.id}async open(t){this.grid=t,this.cross=t.sizes.map(e=>e>>1),this.hovered=null,this.hasMark=t.sizes.length===3,this.look=Gm(t,this.studio.shape.format);let r=t.sizes.length===3;this.panes=t.views.map((n,i)=>{let a=new zm(t,n,e.pane(n.name,r),!r,{point:(e,t)=>this.point(i,e,t),leave:()=>this.leave(),moved:()=>this.request(),slice:e=>this.step(n.fixed,e)});return a.canvas.addEventListener(`keydown`,e=>this.press(i,e)),{pane:a,loading:!1,isWanted:!1,painted:``,paintedBefore:``}}),this.element.replaceChildren(...this.panes.map(({pane:e})=>r?n(`figure`,{},e.element,n(`figcaption`,{},e.view.name)):e.element),this.wipe.divider,this.frames.element);let i=Pm(this.studio.shape);if(i){this.look={...i.look},this.cross=i.cross.map((e,n)=>Math.min(t.sizes[n]-1,Math.max(0,Math.round(e))));for(let[e,{pane:t}]of this.panes.entries())i.panes[e]&&(t.place=i.panes[e])}this.element.classList.toggle(`three`,r),this.openFrames(t,i?.frame??0),this.reload(),await this.waitUntilSettled();let a=this.panes[0]?.pane.plane;if(!a)return;let{step:o}=a.part,[s,c]=this.spacingsOf(this.panes[0]);this.usualHeight=km({values:a.values,rows:a.rows,columns:a.columns,nChannels:a.nChannels},[s*o,c*o]),this.look.mode===`relief`&&this.repaint()}openFrames({frames:e},t){let n=e?.n??1;this.shownFrame=Math.min(n-1,t),this.element.classList.toggle(`series`,n>1);let{id:r,name:i}=this.studio.shape,a={name:i,step:e?.step??null},o=Array.from({length:n},(e,t)=>({name:`${r} ${t}`,series:a,frame:t}));this.frames.set(o,this.shownFrame)}showFrame(e){return this.shownFrame=e,this.request(),this.waitUntilSettled()}get memory(){let{look:e,cross:t,shownFrame:n}=this;return{look:e,cross:t,frame:n,panes:this.panes.map(({pane:e})=>e.place)}}toggleWipe(){this.wipe.toggle(),this.studio.emit(`before`)}reload(){this.content++;for(let e of this.panes)e.pane.plane=null,e.painted=``,e.paintedBefore=``;this.request()}setLook(e){this.look={...this.look,...e},this.repaint()}repaint(){for(let e of this.panes)e.painted=``,e.paintedBefore=``;this.request()}show(){this.grid&&(cancelAnimationFrame(this.drawRequest),this.drawRequest=0,this.draw(),this.release())}showTarget(){this.show()}settle(){this.request()}get isCurrent(){return this.shownDoc===this.studio.doc&&!this.isBusy}get isBusy(){return this.drawRequest!==0||this.panes.some(e=>e.loading)}waitUntilSettled(){return this.isBusy?new Promise(e=>this.waiters.push(e)):Promise.resolve()}request(){this.grid&&this.drawRequest===0&&(this.drawRequest=requestAnimationFrame(()=>{this.drawRequest=0,this.draw(),this.release()}))}release(){if(!this.isBusy)for(let e of this.waiters.splice(0))e()}draw(){let{studio:e,grid:t}=this;if(!t||!e.isGrid||this.element.hidden)return;let n=performance.now(),r=this.gains(),i=e.view.showsOriginal,a=getComputedStyle(this.element),[o,s]=[`--accent`,`--strong`].map(e=>a.getPropertyValue(e)),c=t.n_missing>0,l=this.element.getBoundingClientRect(),u=this.wipe.at===null?null:l.left+this.wipe.at*l.width;for(let e of this.panes){let{pane:t}=e;this.load(e);let{plane:n}=t;if(n){let a=`${this.content} ${JSON.stringify(n.part)} ${r} ${i}`;a!==e.painted&&(i||n.edit(r),t.paint(this.shadingOf(e),i),e.painted=a);let o=`${this.content} ${JSON.stringify(n.part)}`;u!==null&&o!==e.paintedBefore&&(t.paint(this.shadingOf(e),!0,!0),e.paintedBefore=o)}let a=this.hasMark?t.view.axes.map(e=>this.cross[e]):null,l=u===null?null:u-t.canvas.getBoundingClientRect().left;t.draw({smooth:this.look.smooth,cross:a,wipe:l,hasGaps:c,ink:o,muted:s})}this.shownDoc=e.doc,e.timings.recordFrame(n,!0,()=>this.finish()),this.tell()}finish(){for(let{pane:e}of this.panes)e.canvas.getContext(`2d`).getImageData(0,0,1,1)}gains(){let{studio:e}=this;return Wd(j(e.doc.layers,e.solo).filter(e=>e.on).map(({opacity:e,gains:t})=>({opacity:e,gains:t,mask:null})),e.nLevels)}spacingsOf({pane:e}){let[t,n]=e.view.axes;return[this.grid.height_spacings[t],this.grid.height_spacings[n]]}shadingOf(e){let{look:t,grid:n}=this,r=n.n_channels===4&&this.studio.shape.format===`png`;return{mode:t.mode,window:t.window,spacings:this.spacingsOf(e),height:t.relief*this.usualHeight,opacity:r?{full:Um[n.value_type]??1}:null}}load(e){let{pane:t}=e,n=t.view.fixed===null?0:this.cross[t.view.fixed],r=this.grid.frames?this.shownFrame:null,i=t.plane?.part,a=i?.index===n&&i.frame===r?i:null,o=Math.floor(Hm/this.grid.n_channels),s=Ze(t.sizes,t.seen,o,a);s&&(e.loading?e.isWanted=!0:(e.loading=!0,this.fetch(e,{...s,index:n,frame:r}).finally(()=>{e.loading=!1,e.isWanted?(e.isWanted=!1,this.request()):this.release()})))}async fetch(e,t){let{content:n,studio:r}=this,i=this.grid.n_channels;try{let a=await r.api.floats(`shapes/${this.id}/plane?${Je(e.pane.view,t)}`);if(n!==this.content||!this.panes.includes(e))return;e.pane.plane=new Ye(t,i,a),this.request()}catch(e){if(n!==this.content)return;this.frames.stop(),r.showMessage(e.message,`error`)}}point(e,t,n){let{pane:r}=this.panes[e],[i,a]=[Math.round(t[0]),Math.round(t[1])],o=i>=0&&a>=0&&i<r.sizes[0]&&a<r.sizes[1],s=(e,t)=>Math.min(t-1,Math.max(0,e)),c=this.cross.slice();c[r.view.axes[0]]=s(i,r.sizes[0]),c[r.view.axes[1]]=s(a,r.sizes[1]),n===`hover`?(this.hovered=o?c:null,this.tell()):(o||n===`drag`)&&(this.hovered=null,this.setCross(c))}leave(){this.hovered=null,this.tell()}setCross(e){this.cross=e.map((e,t)=>Math.min(this.grid.sizes[t]-1,Math.max(0,e))),this.hasMark=!0,this.request()}step(e,t){this.setCross(this.cross.map((n,r)=>r===e?n+t:n))}press(e,t){if(t.ctrlKey||t.metaKey||t.altKey)return;let{pane:n}=this.panes[e],{axes:r,flips:i,fixed:a}=n.view,o={ArrowUp:[0,-1],ArrowDown:[0,1],ArrowLeft:[1,-1],ArrowRight:[1,1]}[t.key];if(o&&a===null!==t.shiftKey){let e=-48*o[1];n.move(o[0]===1?e:0,o[0]===0?e:0)}else if(o)this.step(r[o[0]],(i[o[0]]?-1:1)*o[1]);else if(t.key===`+`||t.key===`=`)n.enlarge(1.25);else if(t.key===`-`)n.enlarge(.8);else if(t.key===`PageUp`&&a!==null)this.step(a,1);else if(t.key===`PageDown`&&a!==null)this.step(a,-1);else return;t.preventDefault(),t.stopPropagation()}enlarge(e){for(let{pane:t}of this.panes)t.enlarge(e)}fitAll(){for(let{pane:e}of this.panes)e.fitAll()}get place(){let e=this.hovered??(this.hasMark?this.cross:null);if(!e)return null;for(let{pane:t}of this.panes){let{plane:n,view:r}=t;if(!n||r.fixed!==null&&n.part.index!==e[r.fixed])continue;let i=n.at(e[r.axes[0]],e[r.axes[1]]);if(i<0)continue;let a=e=>[...e.subarray(i*n.nChannels,(i+1)*n.nChannels)],{frame:o}=n.part;return{at:e,frame:o,before:a(n.values),after:a(n.edited)}}return null}tell(){let e=this.hovered??(this.hasMark?this.cross:null),t=this.panes.find(({pane:t})=>{let{plane:n,view:r}=t;return n&&e&&(r.fixed===null||n.part.index===e[r.fixed])}),n=t?.pane.plane,r=t?.pane.view.axes,i=n&&r&&e?n.at(e[r[0]],e[r[1]]):-1;this.studio.showSpectrum(n&&i>=0?n.spectrumAt(i):[]);for(let e of this.listeners)e()}get editedPlanes(){return this.panes.map(({pane:e})=>e.plane?.edited??new Float32Array)}async picture(t=null,r=!1){let{width:i,height:a,left:o,top:s}=this.element.getBoundingClientRect(),c=t===null?window.devicePixelRatio||1:t/i,l=n(`canvas`,{width:Math.round(i*c),height:Math.round(a*c)}),u=l.getContext(`2d`);r||(u.fillStyle=getComputedStyle(document.body).backgroundColor,u.fillRect(0,0,l.width,l.height));try{for(let{pane:e}of this.panes)e.ratio=c;this.request(),await this.waitUntilSettled(),this.draw();for(let{pane:e}of this.panes){let t=e.canvas.getBoundingClientRect();u.drawImage(e.canvas,(t.left-o)*c,(t.top-s)*c)}}finally{for(let{pane:e}of this.panes)e.ratio=null;this.request()}return new Promise((t,n)=>l.toBlob(r=>r?t(r):n(Error(e.noPicture))))}};function Gm(e,t){let{least:n,greatest:r,low:i,high:a}=e.range,o=e.value_type===`u8`&&(t===`png`||t===`jpeg`)?[0,255]:[i,a],s=o[1]>o[0]?o:[n,r>n?r:n+1];return{mode:e.terrain?`relief`:e.n_channels>=3?`color`:`gray`,window:s,relief:1,smooth:!1}}var Km=class{arrays;masks=new Map;slots=[];n=0;constructor(e){this.arrays=e}reset(e){this.n=e,this.masks.clear(),this.slots=[]}updateMask(e,t,n){let r=this.masks.get(e);r||(r=new Uint8Array(this.n),this.masks.set(e,r)),r.set(n,t);let i=this.slot(e);i>=0&&this.arrays.setMask(i,t,n)}retainLayers(e){for(let t of this.masks.keys())e.includes(t)||this.masks.delete(t)}get size(){return this.masks.size}has(e){return this.masks.has(e)}slot(e){return this.slots.indexOf(e)}assignSlots(e){let t=e.filter(e=>e.region).map(e=>e.key);if(t.length===this.slots.length&&t.every((e,t)=>e===this.slots[t]))return;let n=this.slots;this.slots=t;for(let[e,r]of t.entries()){let t=this.masks.get(r);t&&n[e]!==r?this.arrays.setMask(e,0,t):!t&&this.n>0&&this.arrays.setMask(e,0,new Uint8Array(this.n))}}},qm=class{ids=new WeakMap;strokeParents=new WeakMap;n=0;sent=new Set;id(e){let t=this.ids.get(e);return t===void 0&&(t=++this.n,this.ids.set(e,t)),t}registerStroke(e,t){this.strokeParents.set(e,t)}updatesFor(e){let t=[];return{updates:t,ids:e.map(e=>{if(!e)return null;let n=this.id(e);return this.sent.has(n)||t.push([n,this.encodeUpdate(e)]),this.sent.add(n),n})}}encodeUpdate(e){let t=this.strokeParents.get(e);if(!t||!(`painted`in t)||!(`painted`in e))return e;let n=this.id(t);return this.sent.has(n)?{extends:n,stroke:e.painted.at(-1)}:e}markUnknown(e){e||(this.sent=new Set);for(let[t]of e??[])this.sent.delete(t)}},Jm=2e6;function Ym(e){return`adwave-history-${e}`}function Xm(e,t){let{past:n,future:r}=t.documents;for(let i=200;i>=1;i=Math.floor(i/2)){let a=n.slice(-i),o=r.slice(-i).reverse(),s=JSON.stringify(Zm(e,[...a,t.doc,...o],a.length));if(!(s.length>Jm))try{sessionStorage.setItem(Ym(e.id),s);return}catch{}}sessionStorage.removeItem(Ym(e.id))}function Zm(e,t,n){let r=[],i=new Map,a=[],o=t.map(e=>{a.includes(e.levels)||a.push(e.levels);let t=b(e,0),n=({region:e})=>e?(i.has(e)||i.set(e,r.push(e)-1),i.get(e)):null,o=e=>e.map(e=>({...e,region:null})),s=t.fields??[];return{levels:a.indexOf(e.levels),edit:{...t,layers:o(t.layers),fields:s.map(e=>({...e,layers:o(e.layers)}))},regions:t.layers.map(n),fieldRegions:s.map(e=>e.layers.map(n))}});return{name:e.name,nVertices:e.n_vertices,levels:a,regions:r,docs:o,present:n}}function Qm(e,t){let n=sessionStorage.getItem(Ym(e.id));if(sessionStorage.removeItem(Ym(e.id)),!n)return!1;try{let r=JSON.parse(n),i=$m(r,t.doc),a=i[r.present],o=e=>eh(b(e,0));return r.name!==e.name||r.nVertices!==e.n_vertices||!a||o(a)!==o(t.doc)?!1:(t.restore(i.slice(0,r.present),i.slice(r.present+1).reverse()),!0)}catch{return!1}}function $m(e,t){let n=e.docs[e.present].levels,r=e.levels.map((e,r)=>r===n?t.levels:e),i=[];for(let{edit:n,levels:a,regions:o,fieldRegions:s}of e.docs){let c=(t,n)=>t.map((t,r)=>({...t,region:n[r]===null?null:e.regions[n[r]]})),l=c(n.layers,o),u=(n.fields??[]).map((e,t)=>({...e,layers:c(e.layers,s[t])})),d=v({...n,layers:l,fields:u},r[a].sigmas.length,r[a]),f=(e,t)=>e.map((e,n)=>({...e,key:t?.[n]?.key??e.key}));i.push({...d,layers:f(d.layers,t.layers),fields:d.fields.map(e=>({...e,layers:f(e.layers,S(t,e.field))}))})}return i}function eh(e){return JSON.stringify(e,(e,t)=>{if(!t||typeof t!=`object`||Array.isArray(t))return t;let n=Object.entries(t).filter(([,e])=>e!==null);return Object.fromEntries(n.sort(([e],[t])=>e<t?-1:1))})}var th=1500,nh=400,rh=6e4,ih=15,ah=class{api;id;revision;onStateChange;state=`saved`;problem=``;conflictingEdit=null;unsavedDoc=null;sending=!1;retry=0;closed=!1;isPaused=!1;constructor(e,t,n,r){this.api=e,this.id=t,this.revision=n,this.onStateChange=r}saveStep(e,t){this.unsavedDoc=e,this.state===`saved`&&this.setState(`sending`),Promise.race([t,new Promise(e=>setTimeout(e,nh))]).then(()=>this.send())}setState(e,t=``){this.state=e,this.problem=t}async send(){if(this.sending||!this.unsavedDoc||this.state===`conflict`||this.closed||this.isPaused)return;window.clearTimeout(this.retry);let e=this.unsavedDoc;this.sending=!0,this.state!==`offline`&&this.setState(`sending`),this.onStateChange(null);try{let t=await this.api.putEdit(this.id,b(e,++this.revision));if(this.sending=!1,this.closed)return;this.unsavedDoc===e?(this.unsavedDoc=null,this.setState(`saved`),this.onStateChange(t)):(this.setState(`sending`),await this.send())}catch(e){if(this.sending=!1,this.closed)return;e instanceof t&&e.status===409?(this.conflictingEdit=ch(e.body),this.conflictingEdit&&(this.revision=Math.max(this.revision,this.conflictingEdit.revision)),this.setState(`conflict`,e.message)):e instanceof t&&e.status===401?this.setState(`ended`,e.message):e instanceof t&&e.status>0?(this.unsavedDoc=null,this.setState(`refused`,e.message)):(this.setState(`offline`,e instanceof Error?e.message:String(e)),this.retry=window.setTimeout(()=>void this.send(),th)),this.onStateChange(null)}}async waitUntilSent(){for(await this.send();this.state===`sending`&&!this.closed;)await new Promise(e=>setTimeout(e,20))}resolve(e){this.state===`conflict`&&(this.setState(e?`sending`:`saved`),e?this.send():this.unsavedDoc=null)}flush(){if(!this.unsavedDoc)return;let e=b(this.unsavedDoc,++this.revision);sessionStorage.setItem(oh(this.id),String(this.revision)),JSON.stringify(e).length<rh&&this.api.putEdit(this.id,e,!0).catch(()=>{})}close(){this.flush(),this.detach()}detach(){this.unsavedDoc=null,this.closed=!0,window.clearTimeout(this.retry)}async pauseDuring(e){await this.waitUntilSent(),this.isPaused=!0;try{return await e(e=>{this.revision=Math.max(this.revision,e),this.unsavedDoc=null})}finally{this.isPaused=!1,this.send()}}get hasUnsavedStep(){return this.unsavedDoc!==null}};function oh(e){return`adwave-flushed-${e}`}async function sh(e,t){let n=Number(sessionStorage.getItem(oh(t)));sessionStorage.removeItem(oh(t));let r=await e.edit(t);for(let i=0;r.revision<n&&i<ih;i++)await new Promise(e=>setTimeout(e,100)),r=await e.edit(t);return r}function ch(e){if(!e||typeof e!=`object`)return null;if(`layers`in e)return e;for(let t of Object.values(e))if(t&&typeof t==`object`&&`layers`in t)return t;return null}var lh=45e3,uh=2e5,dh=class{studio;generation=0;constructor(e){this.studio=e}async open(e){let{studio:t}=this,{view:n,timings:r,api:i}=t,a=++this.generation;this.storeHistory(),t.saver?.close();let[o,s,c]=await Promise.all([e.shape,e.positions,e.triangles]);if(a!==this.generation)return;if(o.grid){await this.openGrid(o,a);return}let l=o.graph?await i.indices(`shapes/${o.id}/edges`):null;if(a!==this.generation)return;t.shape=o,t.showDomain(),sessionStorage.setItem(`adwave-shape`,String(o.id));let u=c.length===0,d=l&&{edges:l,isFlat:o.graph.flat};n.setShape(s,c,d,o.mean_length||o.diagonal/100),ed(n.camera,o);let f=()=>n.arrays.setCoarse(Hd(s,c,lh)),p=n.arrays.heavy&&o.n_triangles>uh;p&&f(),n.markMoving(),n.draw(),r.records.firstPixels||(n.finish(),r.records.firstPixels=performance.now()),t.resetForShape(),t.turnedParts.reset(c,lh),n.setLevels(o.levels.length);let m=t.engine.call(`shape`,{url:`${i.root}api/shapes/${o.id}/`,token:i.token,n:o.n_vertices,center:o.center,diagonal:o.diagonal,meanLength:o.mean_length||o.diagonal/100,cloud:u,positions:s,triangles:c,edges:l,countsEdges:o.graph?.placed===!0}),h=this.readBands(a),g=await sh(i,o.id);a===this.generation&&(this.startEditing(v(g,o.levels.length,fh(o)),g.revision),Qm(o,t.history),t.emit(`shape`),t.emit(`levels`),m.then(({normals:e})=>{a===this.generation&&n.arrays.setNormals(e)}),await h,a===this.generation&&(n.arrays.heavy&&!p&&f(),await this.showEdit(a),t.engine.call(`warm`,{})))}async openGrid(e,t){let{studio:n}=this,r=await sh(n.api,e.id);if(t!==this.generation)return;n.shape=e,sessionStorage.setItem(`adwave-shape`,String(e.id)),n.tool=`look`,n.resetForShape(),n.displacement={...e.grid.change,volume:null},this.startEditing(v(r,e.levels.length,fh(e)),r.revision),Qm(e,n.history),n.showDomain();let i=n.gridView.open(e.grid);n.emit(`shape`),this.markBandsReady(),await i,t===this.generation&&(n.timings.records.slidersLive=performance.now())}markBandsReady(){let{studio:e}=this;for(let t=1;t<=e.nLevels;t++)e.loadedBands.add(t);e.isEditShown=!0,e.emit(`levels`),e.emit(`band`)}async showEdit(e){let{studio:t}=this;t.isEditShown||(t.display.show(!0),t.display.isCurrent||await t.display.waitUntilSettled(),e===this.generation&&(t.isEditShown=!0,t.timings.records.slidersLive=performance.now(),t.emit(`band`)))}storeHistory(){let{shape:e,history:t,saver:n}=this.studio;e&&n&&(Xm(e,t),e.grid?Nm(e,this.studio.gridView.memory):this.studio.shownView&&Zu(e,this.studio.shownView.get()))}startEditing(e,t){let{studio:n}=this;n.saver?.detach(),n.saver=new ah(n.api,n.shape.id,t,e=>this.handleSaved(e)),n.resetDocument(e),n.isEditShown=P(e),n.emit(`saving`)}handleSaved(e){let{studio:t}=this;e&&(t.displacement=e,t.emit(`moved`),!t.isGrid&&oe(t.doc,t.shape)&&t.display.settle(),t.fieldEditor.refine().catch(()=>{})),t.emit(`saving`)}async readBands(e){let{studio:t}=this,n=crossOriginIsolated&&typeof SharedArrayBuffer<`u`;try{await t.engine.call(`bands`,{nLevels:t.nLevels,shared:n})}catch(n){e===this.generation&&t.showMessage(n.message,`error`)}}async setLevels(e){await this.replaceLevels(t=>this.studio.api.levels(this.studio.shape.id,e,t),({levels:e})=>this.studio.history.commit(A(this.studio.doc,e)))}async stepOverLevels(e){let{studio:t}=this,n=t.history.peek(e);n&&await this.replaceLevels(e=>t.api.levels(t.shape.id,n.levels.choice,e),({levels:r})=>{t.history.peek(e)===n?t.history[e]():t.history.commit(A(t.doc,r))})}async applyRecipe(e){let{studio:t}=this,n;await this.replaceLevels(n=>t.api.putRecipe(t.shape.id,e,n),({levels:e,edit:r,field:i})=>{t.history.commit(v(r,e.sigmas.length,e)),n=i??null}),n!==void 0&&t.showTarget(n)}async replaceLevels(t,n){let{studio:r}=this,{generation:i}=this,{saver:a}=r;if(!r.shape||!a)return;let o=await r.wait(e.computingBands,e=>a.pauseDuring(async n=>{let r=await t(e);return n(r.edit.revision),r}));if(!o||i!==this.generation)return;let{levels:s}=o;this.generation++,r.history.end(),r.shape={...r.shape,levels:s,choice:o.choice},r.loadedBands.clear(),r.fieldEditor.close(),r.solo=null,r.isGrid||(r.view.setLevels(s.length),r.view.arrays.setUnedited()),n({...o,levels:fh(r.shape)}),r.isGrid?(r.gridView.reload(),this.markBandsReady(),await r.gridView.waitUntilSettled()):(r.isEditShown=P(r.doc),r.emit(`levels`),await this.readLevels());let{presets:c,fields:l}=await r.api.shape(r.shape.id);r.shape={...r.shape,presets:c,fields:l},r.emit(`levels`)}async readLevels(){let{generation:e}=this;await this.readBands(e),e===this.generation&&(await this.showEdit(e),await this.studio.loadTarget())}applyEdit(t){let{nLevels:n,history:r}=this.studio;if(![t,...t.fields??[]].map(e=>e.layers).every(e=>Array.isArray(e)&&e.every(e=>e.gains.length===n)))throw Error(e.badEdit(n));r.commit(v(t,n,this.studio.doc.levels))}acceptConflictingEdit(){let{saver:e,nLevels:t,display:n}=this.studio,r=e?.conflictingEdit;if(!r)return;e.resolve(!1);let i=v(r,t,this.studio.doc.levels);this.studio.history.commit(i),n.settle()}};function fh({choice:e,levels:t}){return{choice:e,sigmas:t.map(e=>e.sigma)}}var ph=class{records={firstPixels:0,firstSlider:0,slidersLive:0,slider:[],settle:[],pick:[],stamp:[],pull:[],frame:[]};isEnabled=!1;sliderMovedAt=0;startSliderTiming(){this.sliderMovedAt||=performance.now()}cancelSliderTiming(){this.sliderMovedAt=0}recordFrame(e,t,n){if(!this.isEnabled){this.sliderMovedAt=0;return}if(!this.sliderMovedAt||!t)return;let r=this.sliderMovedAt;this.sliderMovedAt=0,n(),this.records.slider.push(performance.now()-r),this.records.frame.push(performance.now()-e)}},mh=class{api;view;showMessage;shape=null;shapes={version:``,shapes:[]};history=new R({layers:[D(``,0)],along:null,border:null,volume:null,clones:[],pose:null,turned:m,fields:h,levels:f},()=>{});saver=null;selected=0;target=null;shownField=null;blankKeys=new Map;lastDoc=null;loadedBands=new Set;isEditShown=!0;displacement=null;spectrum=[];comparison=null;tool=`look`;cloneSource=null;isPulling=!1;solo=null;waiting=new Map;lastWait=0;showField=()=>{};showColors=()=>{};showDomain=()=>{};toggleTheme=()=>{};shownView=null;timings=new ph;engine;regions=new qm;detail=new mm(this);session=new dh(this);shapeDisplay;gridView;fieldEditor=new ym(this);beside;turnedParts=new Yd(this);tint={region:!0,effect:!1};lastVertex=null;lineDrawing=null;picked=null;withdrawRequest=()=>{};listeners=new Map;registersForShapes=!1;masks;constructor(e,t,n,r){this.api=e,this.view=t,this.showMessage=r,this.on(`selected`,()=>{this.solo&&this.solo.key!==this.selected&&(this.solo=null,this.display.showTarget(!0),this.emit(`solo`))}),this.engine=new vm(n,e=>this.handleWorkerEvent(e)),this.masks=new Km(t.arrays),this.shapeDisplay=new _m(this,this.masks),this.gridView=new Wm(this),this.beside=new bp(this)}on(e,t){for(let n of[e].flat()){let e=this.listeners.get(n)??[];e.push({listener:t,forShapes:this.registersForShapes}),this.listeners.set(n,e)}}forShapes(e){this.registersForShapes=!0;try{return e()}finally{this.registersForShapes=!1}}emit(e){for(let{listener:t,forShapes:n}of this.listeners.get(e)??[])n&&this.isGrid||t()}get isGrid(){return this.shape?.grid!==void 0}get display(){return this.isGrid?this.gridView:this.shapeDisplay}markMoving(){this.isGrid||this.view.markMoving()}get isBrushOn(){return this.tool===`brush`}get isGrabOn(){return this.tool===`grab`}get doc(){return this.history.doc}get layers(){return this.layersIn(this.doc)}layersIn(e){let{target:t}=this,n=S(e,t);if(n&&n.length>0)return n;let r=this.blankKeys.get(t??``)??_();return this.blankKeys.set(t??``,r),[{...D(``,this.nLevels),key:r}]}get layer(){return this.layers.find(e=>e.key===this.selected)??this.layers[0]}findLayer(e){return this.layers.find(t=>t.key===e)??w(this.doc).find(t=>t.key===e)}get docWithTarget(){let{doc:e,target:t}=this;return S(e,t)?e:C(e,t,this.layers)}withLayers(e){return C(this.doc,this.target,e)}withGain(e,t,n=this.doc){return this.layer.gains[e-1]===t&&n===this.doc?n:N(n===this.doc?this.docWithTarget:n,this.layer.key,e,t)}keptKeys(e){return[...bm(e),...this.layers.map(e=>e.key)]}isBandReady(e){return this.target===null?this.isEditShown&&this.loadedBands.has(e)&&!this.shape?.graph?.placed:this.fieldEditor.loaded===this.target}async setTarget(e){if(e!==this.target){this.cancelPick(),this.target=e,this.solo=null,this.showSpectrum([]),this.selected=this.layers[0].key,this.masks.assignSlots(this.slottedLayers),this.updateTint();for(let e of[`target`,`selected`,`band`,`solo`])this.emit(e);e===null?(this.fieldEditor.drop(),this.display.settle()):await this.loadTarget()}}async loadTarget(){let{target:e}=this;if(e===null)return;let t=!1;try{t=await this.fieldEditor.load(e)}catch(e){this.showMessage(e.message,`error`)}!t&&this.target===e&&this.fieldEditor.loaded===null&&await this.setTarget(null)}get slottedLayers(){return this.target===null?[...this.doc.layers]:[...this.layers,...this.doc.layers]}get nLevels(){return this.shape?.levels.length??0}resetForShape(){this.masks.reset(this.isGrid?0:this.shape.n_vertices),this.regions.markUnknown(),this.loadedBands.clear(),this.displacement=null,this.comparison=null,this.solo=null,this.lastVertex=null,this.cloneSource=null,this.isPulling=!1,this.target=null,this.shownField=null,this.blankKeys.clear(),this.fieldEditor.close(),this.cancelPick(),this.emit(`compared`),this.emit(`target`)}resetDocument(e){this.history=new R(e,e=>this.handleDocumentChange(e),this.shape?.graph?.placed?F:void 0),this.lastDoc=e,this.selected=this.layers[0].key,this.masks.assignSlots(this.slottedLayers),this.updateTint(),this.showTurned(),this.emit(`doc`),this.emit(`selected`)}handleWorkerEvent(e){if(e.event===`band`){this.view.arrays.setBand(e.level,e.scale,e.values),this.loadedBands.add(e.level);let t=performance.now();this.loadedBands.size===1&&(this.timings.records.firstSlider=t),this.loadedBands.size===this.nLevels&&this.isEditShown&&(this.timings.records.slidersLive=t),this.emit(`band`)}else this.masks.updateMask(e.key,e.from,e.bytes)}handleDocumentChange(e){let t=this.lastDoc;this.lastDoc=this.doc,this.layers.some(e=>e.key===this.selected)||(this.selected=this.layers.at(-1).key,this.emit(`selected`)),this.masks.assignSlots(this.slottedLayers),this.updateTint(),this.target!==null&&this.fieldEditor.show(),this.target!==null&&t&&E(t,this.doc)||this.display.show(e),this.showTurned(),e&&this.saver?.saveStep(this.doc,this.display.waitUntilSettled()),this.emit(`doc`)}async showTurned(){try{await this.turnedParts.show()}catch(e){this.showMessage(e.message,`error`)}}get tintKind(){return lm(this.layer)?`effect`:`region`}updateTint(){if(this.isGrid)return;let e=this.masks.slot(this.selected);this.view.setTint(this.tint[this.tintKind]&&e>=0&&!this.comparison?e:null)}select(e){e!==this.selected&&this.cancelPick(),this.selected=e,this.updateTint(),this.emit(`selected`)}setBefore(e){this.view.showsOriginal!==e&&(this.view.showsOriginal=e,this.isGrid||this.view.request(),this.emit(`before`))}undo(){this.step(`undo`)}redo(){this.step(`redo`)}step(e){if(this.waiting.size>0)return;let t=this.history.peek(e);if(!t)return;if(this.cancelPick(),t.levels!==this.doc.levels){this.session.stepOverLevels(e).catch(e=>this.showMessage(e.message,`error`));return}this.timings.startSliderTiming();let n=T(this.doc,t);this.history[e]()?n!==void 0&&n!==this.target&&this.showTarget(n):this.timings.cancelSliderTiming()}showFirstField(){let e=this.shape?.fields.find(e=>e.editable);e&&this.showTarget(e.name)}showTarget(e){if(e!==null&&e!==this.shownField){if(!this.shape?.fields.some(t=>t.name===e&&t.editable))return;this.showField(e)}this.setTarget(e)}pickCloneSource(){this.requestVertex(e.pickCloneClick,t=>{this.cloneSource=t,this.emit(`tool`),this.showMessage(e.cloneSourcePicked)})}get onPickVertex(){return this.picked}set onPickVertex(e){this.withdrawRequest(),this.picked=e,this.view.canvas.classList.toggle(`picking`,e!==null)}requestVertex(e,t){this.onPickVertex=t,this.withdrawRequest=this.showMessage(e,`request`)}cancelPick(){let{lineDrawing:e}=this,t=e!==null||this.onPickVertex!==null;return this.onPickVertex=null,e?.cancel(),t}async wait(e,t){let n=new AbortController,r=++this.lastWait;this.waiting.set(r,{what:e,cancel:()=>n.abort()}),this.emit(`waiting`);let i=e=>{let t=this.waiting.get(r);t&&(t.what=e,this.emit(`waiting`))},a=new Promise(e=>n.signal.addEventListener(`abort`,()=>e(null)));try{return await Promise.race([t(n.signal,i),a])}catch(e){if(n.signal.aborted)return null;throw e}finally{this.waiting.delete(r),this.emit(`waiting`)}}setSolo(e){let{solo:t,selected:n}=this;this.solo=t?.key===n&&t.level===e?null:{key:n,level:e},this.markMoving(),this.display.showTarget(!0),this.emit(`solo`)}changeLayer(e,t,n=this.selected){let r=M(this.docWithTarget,n,e);t?this.history.commit(r):this.history.preview(r)}addLayer(e,t,n=!0,r=null){this.cancelPick();let i=D(e,this.nLevels,t),a=r?{...i,gains:r}:i,o=this.withLayers([...this.layers,a]);return this.selected=a.key,n?this.history.commit(o):this.history.preview(o),this.select(a.key),a.key}async showMask(e,t){if(!e.region)return;let{updates:n,ids:r}=this.regions.updatesFor([e.region]);try{await this.engine.call(`mask`,{key:e.key,id:r[0],regions:n,smoothing:t})}catch(e){throw this.regions.markUnknown(n),e}}setTool(e){this.tool=e,this.emit(`tool`)}showSpectrum(e){this.spectrum=e,this.emit(`spectrum`)}async fieldRange(t){let{values:n}=await this.api.field(this.shape.id,t,`region`);if(!Ap(n))throw Error(e.emptyField(t));let r=n.reduce((e,t)=>e+Number(Number.isNaN(t)),0);return r>0&&this.showMessage(e.outsideField(t,we(r))),jp(n,`most`,!1)}},hh={look:`turn`,brush:`brush`,grab:`hand`};function gh(t){let r=Object.keys(hh),i=r.map(n=>a(hh[n],e.pointerTools[n],()=>t.setTool(n))),o=()=>{for(let[e,n]of i.entries())n.setAttribute(`aria-pressed`,String(r[e]===t.tool))};return t.on(`tool`,o),t.on(`shape`,()=>{let e=!t.shape?.graph;i[r.indexOf(`grab`)].hidden=!e,!e&&t.isGrabOn&&t.setTool(`look`)}),o(),n(`div`,{class:`toolbar`,role:`group`,"aria-label":e.pointer},...i)}function _h(e,t,n,r){let i=0,a=1/0;for(let o=0;o<e.length;o+=3){let s=e[o]-t,c=e[o+1]-n,l=e[o+2]-r,u=s*s+c*c+l*l;u<a&&(a=u,i=o/3)}return i}function vh(e){let t=[1/0,1/0,1/0],n=[-1/0,-1/0,-1/0];for(let r=0;r<e.length;r+=3)for(let i=0;i<3;i++){let a=e[r+i];a<t[i]&&(t[i]=a),a>n[i]&&(n[i]=a)}let r=t.map((e,t)=>(e+n[t])/2),i=0,[a,o,s]=r;for(let t=0;t<e.length;t+=3){let n=(e[t]-a)**2+(e[t+1]-o)**2+(e[t+2]-s)**2;n>i&&(i=n)}return{low:t,high:n,center:r,radius:Math.sqrt(i)}}function yh(e,t,n,r,i){let a=e.getAttribute(t);a&&a.array.length===n.length&&a.array.constructor===n.constructor?(a.array=n,a.needsUpdate=!0):e.setAttribute(t,new ea(n,r,i))}var bh=16;function xh(e,t,n=!1){let r=Math.ceil(t/4);return r<=2&&(n?4:3)+e+r<=bh?r:null}function Sh({nLevels:e,packs:t,posed:n,cloud:r,flat:i,scalar:a,classes:o,original:s,rgb:c,tint:l,clip:u}){let d=s?`unedited`:`scalar`,f=Array.from({length:e},(e,t)=>t),p=[`x`,`y`,`z`,`w`],m=4*t,h=Array.from({length:m},(e,t)=>`masks${t>>2}.${p[t&3]}`),g=f.map(e=>{let t=h.map((t,n)=>`(1.0 + ${t} * slopes[${e*m+n}])`).join(` * `);return`  d += ((${t?`gains[${e}] * ${t}`:`gains[${e}]`} - 1.0) * scales[${e}]) * band${e}.xyz;`});return`precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
${l?`uniform vec4 tint;
uniform vec4 tint1;
out float vTint;`:``}
${r?`uniform float pointSize;
uniform float pointScale;`:``}
${e?`uniform float gains[${e}];\nuniform float scales[${e}];`:``}
${e&&m?`uniform float slopes[${e*m}];`:``}
in vec3 position;
in vec4 normal;
${n?Ch:``}
${a?`in float ${d};\n${o?`flat `:``}out float vScalar;`:``}
${c?`in vec4 paint;
out vec3 vPaint;`:``}
${l||t>0?`in vec4 masks0;`:``}
${l||t>1?`in vec4 masks1;`:``}
${f.map(e=>`in vec4 band${e};`).join(`
`)}
${i&&!r?``:`out vec3 vNormal;`}
out vec3 vPlace;
${u?`out vec3 vModel;`:``}
void main() {
  vec3 p = position;
${e?`  vec3 d = vec3(0.0);`:``}
${g.join(`
`)}
${e?`  p += ${n?`turned(d)`:`d`};`:``}
  vec4 place = modelViewMatrix * vec4(p, 1.0);
  vPlace = place.xyz;
${u?`  vModel = p;`:``}
${i&&!r?``:`  vNormal = normalMatrix * ${n?`turned(normal.xyz)`:`normal.xyz`};`}
${a?`  vScalar = ${d};`:``}
${c?`  vPaint = paint.rgb;`:``}
${l?`  vTint = dot(masks0, tint) + dot(masks1, tint1);`:``}
  gl_Position = projectionMatrix * place;
${r?`  gl_PointSize = clamp(pointSize / gl_Position.w, 1.5 * pointScale, 64.0 * pointScale);`:``}
}`}var Ch=`in vec4 turn;
vec3 turned(vec3 d) { return d + 2.0 * cross(turn.xyz, cross(turn.xyz, d) + turn.w * d); }`,wh=`  // Clay: a broad highlight from above, dark silhouettes.
  float rim = 1.0 - n.z;
  float top = smoothstep(-0.6, 1.0, dot(n, vec3(-0.35, 0.76, 0.55)));
  float shine = max(0.0, dot(n, vec3(-0.3, 0.55, 0.78)));
  shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  vec3 light = base * (0.32 + 0.85 * top) * (1.0 - 0.55 * rim * rim) + vec3(0.2 * shine);`,Th=`  float key = max(0.0, dot(n, vec3(-0.42, 0.56, 0.71)));
  float fill = max(0.0, dot(n, vec3(0.88, -0.12, 0.46)));
  vec3 light = base * (0.24 + 0.72 * key + 0.18 * fill + 0.06 * n.y);`,Eh=`vec3(0.5, 0.61, 0.8)`,Dh=`(0.1 + 0.75 * step(0.6, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0)))`,Oh=`uniform vec4 clip;
in vec3 vModel;`,kh=`  if (dot(vec4(vModel, 1.0), clip) > 0.0) discard;`;function Ah({cloud:e,clay:t,lit:n,flat:r,scalar:i,classes:a,rgb:o,tint:s,clip:c}){let l=r?`  vec3 n = normalize(cross(dFdx(vPlace), dFdy(vPlace)));`:`  vec3 n = normalize(gl_FrontFacing ? vNormal : -vNormal);`,u=i||o?`vec3(0.62)`:Eh,d={front:`gl_FrontFacing ? vec3(1.0) : ${u}`,back:`gl_FrontFacing ? ${u} : vec3(1.0)`,both:`vec3(1.0)`}[n];return`precision highp float;
uniform vec3 surface;
${s?`uniform vec3 accent;
in float vTint;`:``}
${i?`uniform vec2 range;\nuniform sampler2D colors;\n${a?`flat `:``}in float vScalar;`:``}
${o?`in vec3 vPaint;`:``}
${r&&!e?``:`in vec3 vNormal;`}
in vec3 vPlace;
${c?Oh:``}
out vec4 color;
void main() {
${c?kh:``}
${e?`  vec2 q = 2.0 * gl_PointCoord - 1.0;
  if (dot(q, q) > 1.0) discard;
  vec3 n = dot(vNormal, vNormal) > 1e-6 ? normalize(vNormal) : vec3(0.0, 0.0, 1.0);
  if (n.z < 0.0) n = -n;`:l}
  vec3 base = surface;
${o?`  base = vPaint;`:``}
${i?`  base = vScalar == vScalar ? texture(colors, vec2((vScalar - range.x) / (range.y - range.x), 0.5)).rgb : vec3(0.5);`:``}
${s?`  base = mix(base, accent, ${i||o?Dh:`0.72`} * min(vTint, 1.0));`:``}
${e?``:`  base *= ${d};`}
${t?wh:Th}
  color = vec4(light, 1.0);
}`}var jh=`precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float bias;
in vec3 position;
out vec3 vModel;
void main() {
  vModel = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= bias * gl_Position.w;
}`,Mh=`precision highp float;
uniform vec4 ink;
${Oh}
out vec4 color;
void main() {
${kh}
  color = ink;
}`,Nh=`precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform float pixels; // pixels per model unit at distance 1
uniform float smallest; // pixels of the page
uniform float ratio;
in vec3 position;
in float size;
in float sign;
out float vSign;
out vec3 vModel;
void main() {
  vSign = sign;
  vModel = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = clamp(size * pixels / gl_Position.w, smallest * ratio, 48.0 * ratio);
  gl_Position.z -= 0.002 * gl_Position.w;
}`,Ph=`precision highp float;
uniform vec3 high;
uniform vec3 low;
in float vSign;
${Oh}
out vec4 color;
void main() {
${kh}
  vec2 q = 2.0 * gl_PointCoord - 1.0;
  float r = dot(q, q);
  if (r > 1.0) discard;
  vec3 n = vec3(q.x, -q.y, sqrt(1.0 - r));
  float key = max(0.0, dot(n, normalize(vec3(-0.45, 0.6, 0.75))));
  color = vec4((vSign > 0.0 ? high : low) * (0.45 + 0.6 * key), 1.0);
}`;function Fh(e,t,n,r,i,a){let[o,s,c]=[r[i],r[i+1],r[i+2]];if(a[0]=o,a[1]=s,a[2]=c,!e)return a;let l=n/32767,[u,d,f]=[e[4*t]*l,e[4*t+1]*l,e[4*t+2]*l],p=e[4*t+3]/32767,m=d*c-f*s+p*o,h=f*o-u*c+p*s,g=u*s-d*o+p*c;return a[0]=o+2*(d*g-f*h),a[1]=s+2*(f*m-u*g),a[2]=c+2*(u*h-d*m),a}var Ih=class{geometry=new ha;vertices;constructor(e,t){let n=new Int32Array(t).fill(-1);for(let t of e)n[t]=0;let r=0;for(let e=0;e<t;e++)n[e]===0&&(n[e]=r++);this.vertices=new Uint32Array(r);for(let e=0;e<t;e++)n[e]>=0&&(this.vertices[n[e]]=e);this.geometry.setIndex(new ea(e.map(e=>n[e]),1))}copyAttribute(e,t,n,r){let i=this.geometry.getAttribute(e);if(i?.array.constructor!==t.constructor){let a=t.constructor;i=new ea(new a(n*this.vertices.length),n,r),this.geometry.setAttribute(e,i)}let{array:a}=i;for(let e=0,r=0;e<this.vertices.length;e++){let i=n*this.vertices[e];for(let e=0;e<n;e++)a[r++]=t[i+e]}i.needsUpdate=!0}copyRange(e,t,n,r){let i=this.geometry.getAttribute(e);if(!i)return;let{array:a,itemSize:o}=i,s=this.lowerBound(n),c=this.lowerBound(r);if(s!==c){for(let e=s,n=o*s;e<c;e++){let r=o*this.vertices[e];for(let e=0;e<o;e++)a[n++]=t[r+e]}i.addUpdateRange(o*s,o*(c-s)),i.needsUpdate=!0}}lowerBound(e){let t=0,n=this.vertices.length;for(;t<n;){let r=t+n>>1;this.vertices[r]<e?t=r+1:n=r}return t}},Lh={software:6e4,hardware:4e6},Rh={software:6e4,hardware:3e5},zh=class{software;onChange;nLevels=0;cloud=!1;live=null;scales=[];base=new ha;edited=new ha;comparison=new ha;posed=new ha;fewPosed=null;pulledShape=new ha;by=null;hasUneditedScalar=!1;pulled=null;hasEdited=!1;hasComparison=!1;bands=[];coarse=null;nTriangles=0;n=0;constructor(e,t){this.software=e,this.onChange=t}setShape(e,t,n){this.n=e.length/3,this.cloud=n,this.nTriangles=t.length/3,this.base.setAttribute(`position`,new ea(e,3));let r=n?null:new ea(t,1);for(let e of[this.base,this.edited,this.posed,this.comparison])e.setIndex(r);return this.base}setTriangles(e,t){let n=new ea(e,1);for(let e of[this.base,this.edited,this.posed,this.comparison])e.setIndex(n);t&&(this.coarse?.base.geometry.dispose(),this.coarse?.edited.geometry.dispose(),this.setCoarse(t),this.fewPosed&&this.setPosed(null,null)),this.onChange()}clear(){this.setPosed(null,null);for(let e of[this.base,this.edited,this.posed,this.comparison,this.pulledShape]){e.dispose();for(let t of Object.keys(e.attributes))e.deleteAttribute(t);e.setIndex(null)}this.coarse?.base.geometry.dispose(),this.coarse?.edited.geometry.dispose(),this.coarse=null,this.pulled=null,this.hasEdited=!1,this.hasComparison=!1,this.hasUneditedScalar=!1,this.setLevels(0)}get large(){return this.n>0&&this.nTriangles+(this.cloud?this.n:0)>(this.software?Rh.software:Rh.hardware)}get heavy(){return this.isHeavy(this.nTriangles)}isHeavy(e){return e>(this.software?Lh.software:Lh.hardware)}get hasFew(){return this.heavy&&this.coarse!==null}setNormals(e){this.base.setAttribute(`normal`,new ea(e,4,!0)),this.coarse?.base.copyAttribute(`normal`,e,4,!0),this.onChange()}setEdited(e,t){yh(this.edited,`position`,e,3,!1),yh(this.edited,`normal`,t,4,!0),Bh(this.edited,this.base,[`normal`]),this.coarse?.edited.copyAttribute(`position`,e,3,!1),this.coarse?.edited.copyAttribute(`normal`,t,4,!0),this.hasEdited=!0,this.live=null,this.pulled=null,this.onChange()}get isPosed(){return this.by!==null}get drawn(){return this.hasFew?this.coarse.base.vertices:null}get originals(){return this.base.getAttribute(`position`)?.array??new Float32Array}place(e){let t=this.places;return[t[3*e],t[3*e+1],t[3*e+2]]}nearest([e,t,n]){return _h(this.places,e,t,n)}get places(){return(this.hasEdited?this.edited:this.base).getAttribute(`position`).array}setPosed(e,t){if(this.by=e,!e||!t){this.fewPosed?.dispose(),this.fewPosed=null;return}let{drawn:n}=this,r=n!==null&&t.places.length===3*n.length;if(n){this.fewPosed??=new ha,this.fewPosed.setIndex(this.coarse.base.geometry.index);let e=r?t:Vh(t,n);yh(this.fewPosed,`position`,e.places,3,!1),yh(this.fewPosed,`turn`,e.turns,4,!0)}else yh(this.posed,`position`,t.places,3,!1),yh(this.posed,`turn`,t.turns,4,!0)}startPull(){let{drawn:e,originals:t}=this,n=(this.hasEdited?this.edited:this.base).getAttribute(`normal`)?.array;if(!this.large||!n||this.live&&this.pulled)return;let r=this.by&&(this.fewPosed??this.posed),i=r?.getAttribute(`turn`)?.array??null,a=r?.getAttribute(`position`)?.array??null,o=e?.length??this.n,s={normals:new Int8Array(4*o),offsets:new Float32Array(3*o)},[c,l]=[[0,0,0],[0,0,0]];for(let r=0;r<o;r++){let o=e?e[r]:r;for(let e=0;e<3;e++)c[e]=this.places[3*o+e]-(a?a[3*r+e]:t[3*o+e]);s.offsets.set(Fh(i,r,-1,c,0,l),3*r),s.normals.set(Fh(i,r,-1,n,4*o,l),4*r)}this.pulled=s}get hasPulledNormals(){return this.pulled!==null}pulledBy({places:e,turns:t}){let{drawn:n,originals:r,pulled:i}=this;if(e.length!==i?.offsets.length)return null;let a=[0,0,0],[o,s]=[0,0],c=e.length/3;for(let l=0;l<c;l++){let c=n?n[l]:l;Fh(t,l,1,i.offsets,3*l,a);let u=0;for(let t=0;t<3;t++)u+=(e[3*l+t]+a[t]-r[3*c+t])**2;o=Math.max(o,u),s+=u}return{greatest:Math.sqrt(o),rms:Math.sqrt(s/c)}}showPulled({places:e,turns:t}){let{pulled:n,pulledShape:r}=this;if(e.length!==n?.offsets.length)return!1;let i=new Float32Array(e.length),a=new Int8Array(n.normals.length),o=[0,0,0];for(let r=0;3*r<e.length;r++){Fh(t,r,1,n.offsets,3*r,o);for(let t=0;t<3;t++)i[3*r+t]=e[3*r+t]+o[t];a.set(Fh(t,r,1,n.normals,4*r,o),4*r)}return r.setIndex((this.hasFew?this.coarse.base.geometry:this.base).index),yh(r,`position`,i,3,!1),yh(r,`normal`,a,4,!0),this.live=`pull`,!0}setUnedited(){this.hasEdited=!1,this.live=null,this.onChange()}setComparison(e,t){this.hasComparison=e!==null,e&&t&&(yh(this.comparison,`position`,e,3,!1),yh(this.comparison,`normal`,t,4,!0),Bh(this.comparison,this.base,[`normal`])),this.onChange()}setLevels(e){let t=this.coarse?[this.coarse.base.geometry]:[];this.fewPosed&&t.push(this.fewPosed);for(let e of[this.base,this.edited,this.posed,this.pulledShape,...t])for(let t=0;t<64;t++)e.deleteAttribute(`band${t}`);this.nLevels=e,this.scales=[],this.bands=[],this.live=null}setBand(e,t,n){if(this.scales[e-1]=t*32767,xh(this.nLevels,0)===null)return;if(this.bands[e-1]=n,this.heavy){this.coarse?.base.copyAttribute(`band${e-1}`,n,4,!0);return}if(!this.large)return;let r=new ea(n,4,!0);this.base.setAttribute(`band${e-1}`,r),this.hasEdited&&this.edited.setAttribute(`band${e-1}`,r),this.onChange()}setCoarse(e){let t=new Ih(e,this.n),n=new Ih(e,this.n);Hh(t,this.base);for(let[e,n]of this.bands.entries())n&&t.copyAttribute(`band${e}`,n,4,!0);this.hasEdited&&Hh(n,this.edited),this.coarse={base:t,edited:n}}setMask(e,t,n){if(e>7)return;let r=`masks${e>>2}`,i=this.base.getAttribute(r);i||(i=new ea(new Uint8Array(4*this.n),4,!0),this.base.setAttribute(r,i),this.hasEdited&&this.edited.setAttribute(r,i));let a=i.array;for(let r=0,i=4*t+(e&3);r<n.length;r++,i+=4)a[i]=n[r];i.addUpdateRange(4*t,4*n.length),i.needsUpdate=!0;for(let e of this.coarse?[this.coarse.base,this.coarse.edited]:[])e.geometry.hasAttribute(r)?e.copyRange(r,a,t,t+n.length):e.copyAttribute(r,a,4,!0);this.onChange()}setScalar(e){yh(this.base,`scalar`,e,1,!1),this.hasEdited&&this.edited.setAttribute(`scalar`,this.base.getAttribute(`scalar`)),this.coarse?.base.copyAttribute(`scalar`,e,1,!1),this.coarse?.edited.copyAttribute(`scalar`,e,1,!1)}setUneditedScalar(e){this.hasUneditedScalar=e!==null,e&&(yh(this.base,`unedited`,e,1,!1),this.coarse?.base.copyAttribute(`unedited`,e,1,!1))}setRgb(e){let t=new ea(e,4,!0);this.base.setAttribute(`paint`,t),this.hasEdited&&this.edited.setAttribute(`paint`,t),this.hasComparison&&this.comparison.setAttribute(`paint`,t),this.coarse?.base.copyAttribute(`paint`,e,4,!0),this.coarse?.edited.copyAttribute(`paint`,e,4,!0)}selectGeometry(e,t){if(e&&this.hasComparison)return Bh(this.comparison,this.base,[`normal`]),{geometry:this.comparison,summed:!1,few:!1};if(!e&&this.live===`pull`){let e=this.hasFew;return Bh(this.pulledShape,e?this.coarse.base.geometry:this.base,[`normal`]),{geometry:this.pulledShape,summed:!1,few:e}}let n=!e&&this.live===`sum`&&this.nLevels>0;if(n&&this.by){let e=this.fewPosed??this.posed,{pulled:t}=this;return t&&yh(e,`normal`,t.normals,4,!0),Bh(e,this.fewPosed?this.coarse.base.geometry:this.base,t?[`normal`]:[]),{geometry:e,summed:n,few:this.fewPosed!==null}}let r=!e&&!n&&this.hasEdited?`edited`:`base`,i=t?this.coarse:null;return{geometry:i?i[r].geometry:this[r],summed:n,few:i!==null}}};function Bh(e,t,n=[]){for(let[r,i]of Object.entries(t.attributes))r!==`position`&&!n.includes(r)&&e.getAttribute(r)!==i&&e.setAttribute(r,i)}function Vh({places:e,turns:t},n){let r={places:new Float32Array(3*n.length),turns:new Int16Array(4*n.length)};for(let[i,a]of n.entries())r.places.set(e.subarray(3*a,3*a+3),3*i),r.turns.set(t.subarray(4*a,4*a+4),4*i);return r}function Hh(e,t){for(let[n,r]of Object.entries(t.attributes)){let{array:t,itemSize:i,normalized:a}=r;e.copyAttribute(n,t,i,a)}}var Uh=45e3,Wh=class{body;isCloud;lit;pointSize;bounds;hasScalar=!1;whole=new ha;few;constructor({positions:e,normals:t,triangles:n,meanLength:r,lit:i},a,o){this.lit=i,this.isCloud=n.length===0,this.pointSize=1.4*r,this.bounds=vh(e),this.whole.setAttribute(`position`,new ea(e,3)),this.whole.setAttribute(`normal`,new ea(t,4,!0)),this.isCloud||this.whole.setIndex(new ea(n,1)),this.few=o?new Ih(Hd(e,n,Uh),e.length/3):null,this.few?.copyAttribute(`position`,e,3,!1),this.few?.copyAttribute(`normal`,t,4,!0),this.body=this.isCloud?new mo(this.whole,a):new za(this.whole,a),this.body.frustumCulled=!1}setScalar(e){this.hasScalar=e!==null,e&&(yh(this.whole,`scalar`,e,1,!1),this.few?.copyAttribute(`scalar`,e,1,!1))}choose(e){this.body.geometry=e&&this.few?this.few.geometry:this.whole}dispose(){this.whole.dispose(),this.few?.geometry.dispose()}},Gh=1.4,Kh=40,qh=`precision highp float;
in vec3 position;
void main() {
  gl_Position = vec4(position, 1.0);
}`,Jh=`precision highp float;
uniform sampler2D colors;
uniform sampler2D depths;
uniform vec2 range; // near and far plane
uniform int radius; // pixels
out vec4 color;
float octave(ivec2 at) {
  ivec2 inside = clamp(at, ivec2(0), textureSize(depths, 0) - 1);
  return log2(range.x * range.y / (range.y - texelFetch(depths, inside, 0).r * (range.y - range.x)));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  color = texelFetch(colors, at, 0);
  if (texelFetch(depths, at, 0).r == 1.0) return;
  float here = octave(at);
  float nearer = 0.0;
  for (int y = -1; y <= 1; y++)
    for (int x = -1; x <= 1; x++) nearer += max(0.0, here - octave(at + radius * ivec2(x, y)));
  color.rgb *= exp(-${Kh.toFixed(1)} * nearer / 8.0);
}`,Yh=class{target=new Ir(1,1,{depthTexture:new _o(1,1),magFilter:St,minFilter:St});size=new q;scene=new xi;camera=new rs;uniforms={colors:{value:this.target.texture},depths:{value:this.target.depthTexture},range:{value:new q},radius:{value:1}};constructor(){let e=new ha;e.setAttribute(`position`,new ea(new Float32Array([-1,-1,0,3,-1,0,-1,3,0]),3));let t=new za(e,new jo({glslVersion:Jn,vertexShader:qh,fragmentShader:Jh,uniforms:this.uniforms,depthTest:!1,depthWrite:!1}));t.frustumCulled=!1,this.scene.add(t)}light(e,{near:t,far:n},r,i=null,a=e.getPixelRatio()){i?this.size.set(i.width,i.height):e.getDrawingBufferSize(this.size),this.target.setSize(this.size.x,this.size.y),e.setRenderTarget(this.target),e.clear(),r(),e.setRenderTarget(i),this.uniforms.range.value.set(t,n),this.uniforms.radius.value=Math.max(1,Math.round(Gh*a)),e.render(this.scene,this.camera)}},Xh=class{packs=0;hasScalar=!1;hasClasses=!1;hasRgb=!1;tinted=!1;made=new Map;sums=Zh();tints=[new Pr,new Pr];texture;shared;constructor(){this.texture=new Ha(Dp(`viridis`),256,1),this.texture.magFilter=Tt,this.texture.minFilter=Tt,this.texture.needsUpdate=!0,this.shared={surface:{value:new J},accent:{value:new J},range:{value:new q(0,1)},colors:{value:this.texture},tint:{value:this.tints[0]},tint1:{value:this.tints[1]},pointSize:{value:1},pointScale:{value:1},clip:{value:new Pr}}}get(e){let t=JSON.stringify(e),n=this.made.get(t);return n||(n=new jo({glslVersion:Jn,vertexShader:Sh(e),fragmentShader:Ah(e),side:2,uniforms:{...this.shared,...this.sums}}),this.made.set(t,n)),n}setColors(e,t){this.shared.surface.value.set(...e),this.shared.accent.value.set(...t)}setClip(e){this.shared.clip.value.set(...e??hp)}setPointSize(e,t=1){this.shared.pointSize.value=e,this.shared.pointScale.value=t}setScalarRange(e,t){this.shared.range.value.set(...e),this.hasClasses=t===`classes`,this.texture.magFilter=this.hasClasses?St:Tt,this.texture.minFilter=this.texture.magFilter,this.texture.image.data.set(Dp(t)),this.texture.needsUpdate=!0}setTint(e){for(let e of this.tints)e.set(0,0,0,0);e!==null&&this.tints[e>>2]?.setComponent(e&3,1),this.tinted=e!==null&&e<8}forgetSums(){this.sums=Zh();for(let[e,t]of this.made)JSON.parse(e).nLevels!==0&&(t.dispose(),this.made.delete(e))}setSums(e,t,n,r,i){let a=xh(r,t.reduce((e,t)=>Math.max(e,t.slot+1),0),i);if(a===null)return!1;let o=4*a;(this.sums.gains.value.length!==r||a!==this.packs)&&(this.forgetSums(),this.packs=a,this.sums.gains.value=Array(r).fill(1),this.sums.scales.value=Array(r).fill(0),this.sums.slopes.value=Array(Math.max(1,r*o)).fill(0));let s=this.sums;s.slopes.value.fill(0);for(let i=0;i<r;i++){s.gains.value[i]=e[i],s.scales.value[i]=n[i]??0;for(let e of t)s.slopes.value[i*o+e.slot]=e.slopes[i]}return!0}};function Zh(){return{gains:{value:[]},scales:{value:[]},slopes:{value:[]}}}var Qh=.4,$h=3e3,eg=.12,tg=class{scene;ring=[];balls;handles;mark;lines=new ha;wires=null;edgeInk=[0,0,0];edgeOpacity=Qh;clip=new Pr(...hp);constructor(e){this.scene=e;for(let t of[1,.45]){let n=new so(new ha,ag(t,.0015,this.clip));n.frustumCulled=!1,n.visible=!1,n.renderOrder=2,this.ring.push(n),e.add(n)}this.balls=ng([.87,.43,.2],[.22,.48,.78],this.clip),this.handles=ng([.95,.52,.1],[.13,.42,.82],new Pr(...hp)),this.handles.material.depthTest=!1,this.handles.material.uniforms.smallest.value=14,this.handles.renderOrder=3,this.mark=ng([.85,.1,.45],[.85,.1,.45],this.clip),this.mark.material.uniforms.smallest.value=11,this.mark.renderOrder=3,e.add(this.balls,this.handles,this.mark)}setInk(e,t){for(let[t,n]of this.ring.entries())ig(n).set(...e,t===0?1:.5);this.edgeInk=t}setClip(e){this.clip.set(...e??hp)}setPixels(e,t){this.balls.material.uniforms.pixels.value=e;for(let{material:e}of[this.balls,this.handles,this.mark])e.uniforms.ratio.value=t}showRing(e,t){for(let[n,r]of[e,t].entries()){let e=this.ring[n];e.visible=r!==null&&r.length>0,r&&e.visible&&(e.geometry.dispose(),e.geometry=new ha,e.geometry.setAttribute(`position`,new ea(r,3)))}}showFeatures(e,t){if(this.balls.visible=e.length>0,this.balls.geometry.dispose(),this.balls.geometry=new ha,e.length===0)return;let n=(e,t,n)=>this.balls.geometry.setAttribute(e,new ea(Float32Array.from(t),n));n(`position`,e.flatMap(e=>e.position),3),n(`size`,e.map(e=>t*e.sigma),1),n(`sign`,e.map(e=>e.sign),1)}showHandles(e,t){rg(this.handles,e,t)}showMark(e){rg(this.mark,e??[],e?[1]:[])}setEdges(e,t){this.lines.setIndex(new ea(e,1)),this.wires=new so(this.lines,ag(.35,t===`above`?2e-4:-2e-4,this.clip));let n=t===`below`?Math.sqrt($h/(e.length/2)):1;this.edgeOpacity=Qh*Math.min(1,Math.max(eg,n)),this.wires.frustumCulled=!1,this.wires.renderOrder=1,this.scene.add(this.wires)}get hasEdges(){return this.wires!==null}placeEdges(e,t){this.wires&&(this.wires.visible=e,e&&(this.lines.setAttribute(`position`,t.getAttribute(`position`)),ig(this.wires).set(...this.edgeInk,this.edgeOpacity)))}clear(){this.wires&&this.scene.remove(this.wires),this.wires=null,this.lines.dispose(),this.lines.deleteAttribute(`position`),this.lines.setIndex(null),this.showFeatures([],1),this.showHandles([],[]),this.showMark(null),this.showRing(null,null)}};function ng(e,t,n){let r=new mo(new ha,new jo({glslVersion:Jn,vertexShader:Nh,fragmentShader:Ph,uniforms:{pixels:{value:1},ratio:{value:1},smallest:{value:8},clip:{value:n},high:{value:new J(...e)},low:{value:new J(...t)}}}));return r.frustumCulled=!1,r.visible=!1,r}function rg(e,t,n){e.visible=n.length>0,e.geometry.dispose(),e.geometry=new ha;let r=(t,n,r)=>e.geometry.setAttribute(t,new ea(Float32Array.from(n),r));r(`position`,t,3),r(`size`,n.map(()=>0),1),r(`sign`,n,1)}function ig(e){return e.material.uniforms.ink.value}function ag(e,t,n){return new jo({glslVersion:Jn,vertexShader:jh,fragmentShader:Mh,uniforms:{ink:{value:new Pr(0,0,0,e)},bias:{value:t},clip:{value:n}},transparent:!0,depthWrite:!1})}var og={light:{surface:14276562,accent:680634,paper:16053490,ink:1776928},dark:{surface:12434358,accent:4891647,paper:1513498,ink:15921904}};X.enabled=!1;var sg={large:.6,small:1,rest:2},cg=160,lg=1500,ug=class{canvas;camera=new Ku;renderer;rendererName;arrays;style=`shaded`;lit=`front`;showsOriginal=!1;split=null;onDrawn=null;frameListeners=[];moveListeners=[];software;scene=new xi;besideScene=new xi;materials=new Xh;overlays;eyeDome=new Yh;clip=null;bounds={low:[0,0,0],high:[0,0,0]};body=null;beside=null;size={width:1,height:1};pointSize=1;isGraph=!1;pointScale=1;frame=0;moving=0;smoothing=0;lens=this.camera.three;paper=[1,1,1];isAtRest=!1;constructor(e){this.canvas=e,this.renderer=new Iu({canvas:e,antialias:!1,alpha:!1,powerPreference:`high-performance`});let t=this.renderer.getContext(),n=t.getExtension(`WEBGL_debug_renderer_info`);this.rendererName=String(t.getParameter(n?n.UNMASKED_RENDERER_WEBGL:t.RENDERER)),this.software=/llvmpipe|swiftshader|softpipe|software|basic render/i.test(this.rendererName),this.renderer.setPixelRatio(this.software?sg.small:Math.max(2,Math.min(3,devicePixelRatio))),this.renderer.autoClear=!1,this.renderer.outputColorSpace=`srgb-linear`,this.arrays=new zh(this.software,()=>this.request()),this.overlays=new tg(this.scene),this.setTheme(`light`)}setTheme(e){let t=og[e];this.materials.setColors(dg(t.surface),dg(t.accent)),this.renderer.setClearColor(t.paper,1),this.paper=dg(t.paper),this.overlays.setInk(dg(t.ink),dg(e===`dark`?0:og.light.ink)),this.request()}setShape(e,t,n,r){this.clear();let i=t.length===0;this.isGraph=n!==null,n&&this.overlays.setEdges(n.edges,`below`),this.pointSize=r*1.4;let a=this.arrays.setShape(e,t,i),o=new jo;this.body=i?new mo(a,o):new za(a,o),this.body.frustumCulled=!1,this.scene.add(this.body);let{low:s,high:c,center:l,radius:u}=vh(e);this.bounds={low:s,high:c},this.camera.setBounds(l,u,r),this.camera.isFlat=n?.isFlat??!1,this.camera.outline=e,this.setClip(null),this.camera.start(),this.request()}setBeside(e){if(this.beside?.dispose(),this.besideScene.clear(),this.beside=null,e){let t=this.arrays.isHeavy(e.triangles.length/3);this.beside=new Wh(e,new jo,t),this.besideScene.add(this.beside.body)}this.camera.setCompany(this.beside?.bounds??null),this.resize(this.size.width,this.size.height),this.camera.frame()}setBesideScalar(e){this.beside?.setScalar(e),this.request()}get halves(){return this.beside?this.size.width>=this.size.height?`beside`:`below`:`one`}get part(){let{width:e,height:t}=this.size;return this.halves===`one`?{width:e,height:t}:this.halves===`beside`?{width:e/2,height:t}:{width:e,height:t/2}}placeInHalf({x:e,y:t}){let{width:n,height:r}=this.part;return this.halves===`beside`&&e>n?{x:e-n,y:t,isSecond:!0}:this.halves===`below`&&t>r?{x:e,y:t-r,isSecond:!0}:{x:e,y:t,isSecond:!1}}clear(){this.body&&this.scene.remove(this.body),this.body=null,this.arrays.clear(),this.materials.hasScalar=!1,this.materials.hasRgb=!1,this.materials.tinted=!1,this.materials.forgetSums(),this.overlays.clear()}get isEyeDome(){return this.arrays.cloud&&!this.isGraph}setLevels(e){this.arrays.setLevels(e),this.materials.forgetSums()}setTint(e){this.materials.setTint(e),this.request()}setRgb(e){this.materials.hasRgb=e!==null,this.materials.hasScalar=!1,e&&this.arrays.setRgb(e),this.request()}setScalar(e,t=[0,1],n=`viridis`,r=null){this.materials.hasScalar=e!==null,this.materials.hasRgb=!1,this.arrays.setUneditedScalar(e&&r),e&&(this.arrays.setScalar(e),this.materials.setScalarRange(t,n)),this.request()}updateScalar(e){this.arrays.setScalar(e),this.request()}setScalarRange(e,t){this.materials.setScalarRange(e,t),this.request()}setGains(e,t){let{arrays:n}=this;return n.heavy&&!n.hasFew||!this.materials.setSums(e,t,n.scales,n.nLevels,n.isPosed)?!1:(n.live=`sum`,this.request(),!0)}showPulled(e){let t=this.arrays.showPulled(e);return t&&this.request(),t}setClip(e){this.clip=e;let t=e&&gp(e,this.bounds);this.camera.clip=t,this.materials.setClip(t),this.overlays.setClip(t),this.request()}clipPlace(e){return-gp({...e,flipped:!1},this.bounds)[3]}hides(e){return this.camera.clip!==null&&_p(this.camera.clip,e)}setEdges(e){this.overlays.setEdges(e,`above`),this.request()}get hasEdges(){return this.overlays.hasEdges}showRing(e,t){this.overlays.showRing(e,t),this.request()}showHandles(e,t){this.overlays.showHandles(e,t),this.request()}showMark(e){this.overlays.showMark(e),this.request()}showFeatures(e,t){this.overlays.showFeatures(e,t),this.request()}resize(e,t){this.size={width:e,height:t},this.renderer.setSize(e,t,!1),this.camera.resize(this.part.width,this.part.height),this.request()}markMoving(){for(let e of this.moveListeners.splice(0))e();window.clearTimeout(this.moving),window.clearTimeout(this.smoothing),this.isAtRest=!1,this.moving=window.setTimeout(()=>{this.moving=0,this.arrays.hasFew&&this.request(),this.software&&(this.smoothing=window.setTimeout(e,this.arrays.hasFew?lg:0))},cg);let e=()=>{this.isAtRest=!0,this.request()};this.request()}request(){this.frame||=requestAnimationFrame(()=>{this.frame=0,this.draw()})}afterFrame(e){this.frameListeners.push(e)}afterNextMove(e){this.moveListeners.push(e)}draw(){cancelAnimationFrame(this.frame),this.frame=0;let e=performance.now(),{renderer:t}=this,n=this.arrays.hasFew&&(this.moving!==0||this.arrays.live!==null);this.software&&this.setRatio(n);let r=t.domElement.width,i=t.domElement.height;if(!this.body||r===0){t.clear();return}t.clear();let a=t.getPixelRatio(),o=this.halves===`one`?{width:r/a,height:i/a}:this.part,s=o.height*a/(2*Math.tan(15*Math.PI/180));this.materials.setPointSize(this.pointScale*this.pointSize*s),this.overlays.setPixels(s,a);let c=this.halves===`below`?o.height:0;this.beside&&t.setViewport(0,c,o.width,o.height);let l=()=>this.drawShape(this.showsOriginal,n);if(this.split===null&&!this.beside)this.isEyeDome&&(this.isAtRest||!this.software)?this.eyeDome.light(t,this.camera.three,l):l();else{if(t.setScissorTest(!0),this.split===null)t.setScissor(0,c,o.width,o.height),this.drawShape(this.showsOriginal,n);else{let e=Math.round(this.split*o.width);t.setScissor(0,c,e,o.height),this.drawShape(!0,n),t.setScissor(e,c,o.width-e,o.height),this.drawShape(!1,n)}this.beside&&this.drawBeside(this.beside,o,s),t.setScissorTest(!1)}this.onDrawn?.(e);for(let e of this.frameListeners)e()}setRatio(e){let t=this.renderer.getPixelRatio(),n=e?t:this.isAtRest?sg.rest:sg.small,r=this.moving===0?n:e?sg.large:sg.small;t!==r&&this.renderer.setPixelRatio(r)}drawBeside(e,t,n){let{renderer:r,materials:i}=this,[a,o]=this.halves===`beside`?[t.width,0]:[0,0];r.setViewport(a,o,t.width,t.height),r.setScissor(a,o,t.width,t.height),i.setPointSize(this.pointScale*e.pointSize*n),e.choose(this.moving!==0),e.body.material=i.get({nLevels:0,packs:0,posed:!1,cloud:e.isCloud,clay:this.style===`matcap`,lit:e.lit,flat:this.style===`flat`,scalar:e.hasScalar,classes:!1,original:!1,rgb:!1,tint:!1,clip:this.clip!==null}),r.render(this.besideScene,this.camera.three),r.setViewport(0,0,this.size.width,this.size.height)}drawShape(e,t){let n=this.body,{materials:r,arrays:i}=this,{geometry:a,summed:o,few:s}=i.selectGeometry(e,t);n.geometry=a,n.material=r.get({nLevels:o?i.nLevels:0,packs:o?r.packs:0,posed:o&&i.isPosed,cloud:i.cloud,clay:this.style===`matcap`,lit:this.lit,flat:o&&!i.hasPulledNormals||this.style===`flat`||!a.hasAttribute(`normal`),scalar:r.hasScalar,classes:r.hasScalar&&r.hasClasses,original:r.hasScalar&&e&&i.hasUneditedScalar,rgb:r.hasRgb,tint:r.tinted&&!e,clip:this.clip!==null}),this.overlays.placeEdges((this.isGraph||this.style===`edges`)&&!o&&!s,a),this.renderer.render(this.scene,this.lens)}drawSamples({camera:e,whole:t,part:n,margin:r,scale:i,ground:a}){let{renderer:o}=this,[s,c]=[n.width+2*r,n.height+2*r],l=new Ir(s,c),u=e.three;u.setViewOffset(t.width,t.height,n.x-r,n.y-r,s,c);let d=t.height/(2*Math.tan(u.fov*Math.PI/360));this.materials.setPointSize(this.pointScale*this.pointSize*d,i/o.getPixelRatio()),this.overlays.setPixels(d,i);let f=new Uint8Array(4*n.width*n.height);try{this.lens=u,o.setClearColor(new Z().setRGB(...a??[0,0,0]),+!!a),o.setRenderTarget(l),o.clear();let e=()=>this.drawShape(this.showsOriginal,!1);this.isEyeDome?this.eyeDome.light(o,u,e,l,i):e(),o.readRenderTargetPixels(l,r,r,n.width,n.height,f)}finally{o.setRenderTarget(null),o.setClearColor(new Z().setRGB(...this.paper),1),u.clearViewOffset(),this.lens=this.camera.three,l.dispose(),this.request()}return f}finish(){let e=this.renderer.getContext();e.readPixels(0,0,1,1,e.RGBA,e.UNSIGNED_BYTE,new Uint8Array(4))}};function dg(e){return[(e>>16)/255,(e>>8&255)/255,(e&255)/255]}var fg={info:5e3,error:12e3,perCharacter:60};function pg(){let e=n(`div`,{class:`toasts`,role:`status`,"aria-live":`polite`}),t=0,r=!1;for(let e of[`pointerdown`,`keydown`,`input`,`change`,`drop`])window.addEventListener(e,()=>r=!0,{capture:!0});let i=()=>{window.clearTimeout(t),e.replaceChildren()};return{element:e,showMessage:(a,o=`info`,s)=>{let c=n(`p`,{class:o,role:o===`error`?`alert`:void 0},s?`${a} `:a),l=()=>{c.isConnected&&i()};return s&&c.append(n(`button`,{type:`button`,class:`link`,onclick:()=>{l(),s?.onclick()}},s.label)),i(),e.append(c),r=!1,o!==`request`&&(t=window.setTimeout(i,Math.max(fg[o],fg.perCharacter*a.length))),l},goOn:()=>{r&&!e.querySelector(`.request`)&&i()}}}function mg(t,r,i,o){let{view:s}=t,c=a(`undo`,e.undo,()=>t.undo()),l=a(`redo`,e.redo,()=>t.redo()),u=a(`before`,e.before,()=>{});u.addEventListener(`pointerdown`,()=>t.setBefore(!0));for(let e of[`pointerup`,`pointerleave`,`pointercancel`])u.addEventListener(e,()=>t.setBefore(!1));u.addEventListener(`keydown`,e=>{(e.key===` `||e.key===`Enter`)&&t.setBefore(!0)}),u.addEventListener(`keyup`,()=>t.setBefore(!1));let d=a(`split`,e.split,()=>t.isGrid?t.gridView.toggleWipe():i.toggleSplit()),f=n(`span`,{class:`badge`,hidden:!0},e.beforeShort);t.on([`doc`,`shape`,`waiting`],()=>{c.disabled=!t.history.canUndo||t.waiting.size>0,l.disabled=!t.history.canRedo||t.waiting.size>0}),t.on([`before`,`compared`,`shape`],()=>{f.hidden=!s.showsOriginal,f.textContent=t.comparison?e.compareShort[t.comparison.method]:e.beforeShort,u.setAttribute(`aria-pressed`,String(s.showsOriginal));let n=t.isGrid?t.gridView.wipe.at:s.split;d.setAttribute(`aria-pressed`,String(n!==null))});let p=n(`button`,{type:`button`,class:`wide-only`,onclick:()=>r.openTools()},e.tools);return t.on(`shape`,()=>{p.hidden=t.isGrid}),{bar:n(`header`,{class:`bar`},n(`h1`,{},`adwave`),r.tabs(),o,n(`span`,{class:`group`},c,l),n(`span`,{class:`group`},u,d),n(`span`,{class:`group`},xg(t),a(`help`,e.help,()=>Jf(t.isGrid))),p,n(`button`,{type:`button`,class:`primary`,onclick:()=>r.openMenu()},e.file)),badge:f}}function hg(t,r){let i=n(`span`,{class:`saving`,role:`status`,title:e.editSavedHint}),a=n(`div`,{class:`banner`,hidden:!0,role:`alert`}),o=(e,t)=>n(`button`,{type:`button`,onclick:t},e),s=()=>{};return t.on(`saving`,()=>{let{saver:c}=t;if(!c)return;let{state:l}=c,u={saved:e.editSaved,sending:e.sending,offline:e.offline,ended:e.offline},d=l===`saved`&&!t.history.canUndo&&!t.shape?.resumed;if(i.textContent=d?``:u[l]??``,i.dataset.state=l,a.hidden=![`offline`,`ended`,`conflict`].includes(l),l===`offline`||l===`ended`){let t=l===`offline`?e.offlineBanner:e.endedBanner;a.replaceChildren(n(`p`,{},t),o(e.editSave,()=>r.saveEdit()))}l===`conflict`&&a.replaceChildren(n(`p`,{},e.conflictBanner),o(e.keepMine,()=>{c.resolve(!0),t.emit(`saving`)}),o(e.takeTheirs,()=>t.session.acceptConflictingEdit())),s(),l===`refused`&&(s=t.showMessage(c.problem,`error`))}),{saving:i,banner:a}}function gg(t){let r=n(`div`,{class:`waiting-notice`,hidden:!0,role:`status`}),i=0,a=()=>{r.hidden=t.waiting.size===0,r.replaceChildren(...[...t.waiting.values()].map(({what:t,cancel:r})=>n(`p`,{},n(`i`,{class:`spinner`,"aria-hidden":`true`}),n(`span`,{},t),n(`button`,{type:`button`,onclick:r},e.cancel))))};return t.on(`waiting`,()=>{window.clearTimeout(i),t.waiting.size===0||!r.hidden?a():i=window.setTimeout(a,200)}),r}function _g(t,r){let i=e=>{r.dataset.tab=e,e!==`equalizer`&&(r.dataset.side=e);for(let e of a){let t=e.dataset.group===`side`?r.dataset.side:r.dataset.tab,n=e.dataset.tab===t;e.setAttribute(`aria-selected`,String(n)),e.tabIndex=n?0:-1}},a=[],o=(t,r)=>{let o=r.map(r=>n(`button`,{type:`button`,role:`tab`,"aria-controls":r,"data-tab":r,"data-group":t,onclick:()=>i(r)},e.tabs[r]));a.push(...o);let s=e=>{let t=o.filter(e=>!e.hidden),n=t.indexOf(e.target),r={ArrowLeft:n-1,ArrowRight:n+1,Home:0,End:-1}[e.key];if(r===void 0)return;e.preventDefault(),e.stopPropagation();let i=t.at(r%t.length);i.click(),i.focus()},c={"aria-label":e.panels},l=n(`div`,{role:`tablist`,...c,onkeydown:s},...o);return n(`nav`,{class:`${t}-tabs`,...c},l)},s=o(`side`,[`layers`,`brush`,`look`,`grid`]),c=o(`sheet`,[`equalizer`,`layers`,`brush`,`look`,`grid`]);i(`layers`),i(`equalizer`);let l=!1;return t.on(`tool`,()=>{let e=t.isBrushOn||t.isGrabOn;if(e&&!l){let e=r.dataset.tab;i(`brush`),e===`equalizer`&&i(`equalizer`)}l=e}),{side:s,sheet:c,choose:()=>{for(let e of a){let n=e.dataset.tab===`grid`;e.hidden=e.dataset.tab!==`equalizer`&&n!==t.isGrid}let e=r.dataset.tab,n=r.dataset.side===`grid`===t.isGrid;n||i(t.isGrid?`grid`:`layers`),!n&&e===`equalizer`&&i(`equalizer`)}}}function vg(t){let n=new Set;t.on(`shape`,()=>{let r=t.shape;document.title=`${r.name} – ${e.title}`,localStorage.getItem(`adwave-visited`)||t.showMessage(e.firstVisits[r.kind]??e.firstVisit),localStorage.setItem(`adwave-visited`,`yes`),r.resumed&&!n.has(r.id)&&t.showMessage(r.grid?e.gridResumed:e.resumed);let i=qd(r,t.doc.turned);if(i.length>0){let n=()=>t.turnedParts.set(qd(r,t.doc.turned),!0),a=e.inward(i.length,r.components);t.showMessage(a,`info`,{label:e.turn,onclick:n})}n.add(r.id),(t.nLevels===0||r.diagonal===0)&&t.showMessage(e.tooSmall,`error`)})}async function yg(t,{list:n,early:r},i,a){try{t.shapes=await n,t.emit(`shapes`);let i=await r;if(!i){a.textContent=e.noShape;return}let o=t.session.open(i);i.positions.then(e=>e.length>0&&a.remove()),await o,await t.display.waitUntilSettled()}catch(e){throw a.textContent=e.message,a.classList.add(`error`),i.append(a),e}}function bg(t){let r=document.getElementById(`app`),i=pg(),a=n(`canvas`,{class:`picture`,tabIndex:0,"aria-label":e.stage}),o;try{o=new ug(a)}catch{r.replaceChildren(n(`p`,{class:`fatal`,role:`alert`},e.noWebgl));return}let s=new Worker(new URL(new URL(`worker.js`,import.meta.url).href,``+import.meta.url),{type:`module`}),c=new mh(t.api,o,s,i.showMessage);c.on([`doc`,`selected`,`tool`,`target`,`shape`,`levels`],i.goOn);let l=c.forShapes(()=>new pm(c,a)),u=c.forShapes(()=>Xp(c,l)),d=new ef(c,t.fetchShape),{saving:f,banner:p}=hg(c,d),{bar:m,badge:h}=mg(c,d,u,f),g=n(`p`,{class:`loading`},e.loading),_=tm(o);c.on(`shape`,()=>{_.hidden=c.shape?.graph?.placed===!0});let v=c.forShapes(()=>[n(`div`,{class:`of-shapes`},a,new Cf(c,l).element,u.divider,u.readouts,u.card,u.legend,u.frames,gh(c),_,Bd(c),c.beside.labels()),n(`div`,{class:`of-shapes`},mp(c),Le(c),u.panel)]),{gridView:y}=c,b=[y.element,n(`div`,{class:`of-shapes`},it(c,y))],x=n(`main`,{class:`stage`},v[0],b[0],h,p,gg(c),g,i.element),S=_g(c,r);r.replaceChildren(m,x,vt(c),n(`aside`,{class:`side`,"aria-label":e.panels},S.side,v[1],b[1]),S.sheet);let C=()=>{o.resize(x.clientWidth,x.clientHeight),w()},w=()=>{x.classList.toggle(`beside`,o.halves===`beside`),x.classList.toggle(`below`,o.halves===`below`)};c.on(`beside`,w);let T=()=>{r.dataset.domain=c.isGrid?`grid`:`shape`;for(let e of v)e.hidden=c.isGrid;for(let e of b)e.hidden=!c.isGrid;S.choose()};c.showDomain=T,T(),new ResizeObserver(C).observe(x),C(),Xf(c,l,u,d),d.acceptDrops(r),vg(c),window.addEventListener(`pagehide`,()=>{c.history.end(),c.saver?.flush(),c.session.storeHistory()}),a.addEventListener(`webglcontextlost`,()=>{l.interrupt();let t=c.showMessage(e.lostPicture);a.addEventListener(`webglcontextrestored`,()=>{t(),o.request()},{once:!0})}),yg(c,t,r,g).catch(()=>{}),c.on(`shape`,()=>g.remove())}function xg(t){let n=matchMedia(`(prefers-color-scheme: dark)`),r=localStorage.getItem(`adwave-theme`),i=()=>{let e=r??(n.matches?`dark`:`light`);document.documentElement.dataset.theme=e,t.view.setTheme(e),t.emit(`theme`)};return n.addEventListener(`change`,i),i(),t.toggleTheme=()=>{r=document.documentElement.dataset.theme===`dark`?`light`:`dark`,localStorage.setItem(`adwave-theme`,r),i()},a(`theme`,e.theme,t.toggleTheme,{class:`icon wide-only`})}export{bg as start};