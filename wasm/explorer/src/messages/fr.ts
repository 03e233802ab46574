import type { Messages } from "./en";

/** Parameters of a capsule in the channel, by their names in the core. */
const PARAMETERS: Record<string, string> = { capillary_number: "Ca", confinement: "a/ℓ" };
const parameter = (name = "") => PARAMETERS[name] ?? name;

/** Values that the core names in words. */
const VALUES: Record<string, string> = {
  "the instant": "l’instant",
  "the step": "le pas",
  "the number of points": "le nombre de points",
};

/** Units of a text's numbers, by their names in the core. */
const UNITS: Record<string, string> = { um: "µm" };

/** The page's words in French. Numbers keep the decimal point, as in the files. */
export const fr: Messages = {
  page: {
    about: "Une microcapsule élastique dans un microcanal carré",
    tour: "Visite",
    model: "Modèle",
    newVersion: "Nouvelle version : recharger",
    units: "Unités…",
    export: "Exporter…",
    copyLink: "Copier le lien",
    openModel: "Ouvrir…",
    openModelHint: "Un modèle (.crom) ou une session enregistrée, que l’on peut aussi déposer sur la page",
    help: "Raccourcis et aide",
    helpHint: "Raccourcis et aide (?)",
    modelFile: "Fichier d’un modèle (.crom) ou d’une session (.json)",
    loading: "Chargement du modèle d'ordre réduit…",
    parameters: "Paramètres",
    layer: "Lignes de niveau sur la carte",
    scale: "Échelle de Ca sur la carte",
    samples: "Points",
    capillaryNumber: 'Nombre capillaire <i class="symbol">Ca</i>',
    confinement: 'Confinement <i class="symbol">a/ℓ</i>',
    method: "Méthode",
    direct: "Directe",
    paper: "Article",
    frame: "Référentiel",
    laboratory: "Laboratoire",
    centroid: "Barycentre",
    readouts: "Grandeurs",
    extrapolated: "Extrapolées",
    uncertain: "Incertaines",
    readoutsHint: "en choisir une à tracer",
    pin: "Épingler",
    pinHint: "Garder cette requête pour la comparer à d’autres",
    unitsNote: `<i class="symbol">ℓ</i> demi-côté du canal, <i class="symbol">V</i> vitesse moyenne de l’écoulement,
      <i class="symbol">a</i> rayon de la capsule, <i class="symbol">B</i> rigidité de flexion de la membrane, en
      <i class="symbol">G</i><sub>s</sub><i class="symbol">a</i>².`,
    solid: "Capsule dans le canal",
    initial: "Forme initiale",
    flow: "Écoulement",
    flowHint: "Profil de l’écoulement non perturbé dans le référentiel choisi, dans le plan z = 0 et en 3D",
    colour: "Couleur de la membrane",
    clip: "Plan de coupe qui ouvre la capsule",
    cameras: "Point de vue",
    noShape: "Aucune forme à montrer",
    hold: "Figer l’échelle",
    transversal: "Coupe transversale",
    planeAcross: "Plan",
    section: "Position axiale du plan transversal par rapport au barycentre, en l",
    midplane: "Coupe longitudinale",
    planeZ: 'plan <i class="symbol">z</i> = 0',
    measuredKey: "contour mesuré",
    diagonal: "Coupe diagonale",
    planeYZ: 'plan <i class="symbol">y</i> = <i class="symbol">z</i>',
    plots: "Toutes les grandeurs",
    along: "Variable en abscisse des courbes",
    measured: "Contour mesuré",
    outlineFile: "Fichier d’un contour mesuré : points en texte ou image",
    compare: "Comparaison",
    transport: "Temps et vues",
    play: "Lecture",
    time: "Temps",
    listenHint: "Écouter la courbe : la hauteur du son suit la valeur (L)",
    speed: "Allure",
    speedName: "Allure de la lecture, en l/V par seconde",
    views: "Vues",
    exportTitle: "Exporter",
    exportNote: "Chaque fichier indique le modèle, les paramètres et l’erreur.",
    close: "Fermer",
    unitsTitle: "Unités physiques",
    unitsIntroduction: `Des dimensions de l’expérience à <i class="symbol">Ca</i> =
      <i class="symbol">μV</i>/<i class="symbol">G</i><sub>s</sub>
      et <i class="symbol">a/ℓ</i>, et inversement. Chaque nombre suit les autres.`,
    dimensionless: "Revenir aux nombres sans dimension",
    back: "Retour",
    next: "Suivant",
    closeTour: "Fermer la visite",
    keySpace: "Espace",
    doesSpace: "lecture ou pause",
    doesArrows: "un pas de temps ; avec Maj, dix",
    keyEnds: "Début, Fin",
    doesEnds: "premier et dernier instant",
    doesL: "écouter la courbe dans le temps, ou l’arrêter : la hauteur du son suit la valeur",
    keyMap: "flèches",
    doesMap: "sur la carte : changer Ca et a/ℓ ; avec Maj, plus finement",
    keyTurn: "flèches, + −",
    doesTurn: "sur la vue 3D : tourner et zoomer",
    doesCameras: "vue 3D : oblique, de côté, de face",
    doesHelp: "cette fiche",
    aboutCa: `Rapport des forces visqueuses aux forces élastiques, <i class="symbol">μV</i>/<i
      class="symbol">G</i><sub>s</sub> : viscosité, vitesse moyenne et module de cisaillement surfacique de la membrane.
      Plus il est grand, plus la capsule se déforme.`,
    aboutConfinement: "Rapport du rayon de la capsule au demi-côté du canal.",
    methodsTerm: "Directe et Article",
    aboutMethods: `Deux méthodes sur les mêmes données. La méthode directe interpole le mouvement lui-même ; celle de
      l’article avance pas à pas, comme Boubehziz et al., <cite>Entropy</cite> 2021, 23, 1193. L’erreur indique laquelle
      est la plus proche du modèle complet.`,
    dataTerm: "Données",
    aboutData: `Simulations d’un modèle complet : intégrales de frontière pour l’écoulement, éléments finis pour la
      membrane. Les points de la carte sont les paramètres simulés.`,
    outlineTerm: "Contour",
    aboutOutline: `Déposer ou coller le contour d’une capsule mesurée, points en texte ou image : la page trouve le
      <i class="symbol">Ca</i>, le rayon et le module de cisaillement surfacique qui s’ajustent le mieux, avec leurs
      incertitudes.`,
    errorsTerm: "Erreurs",
    aboutErrors: `95 % des erreurs sont inférieures à la borne. Un contour en tirets et « ≈ » signalent une réponse dont
      la borne dépasse 2 % de <i class="symbol">a</i>, ou qui n’en a pas ; la bande autour d’un contour a la largeur de
      la borne.`,
    citeTerm: "Pour citer",
    aboutCiting:
      "L’article ci-dessus, et capsule-rom avec l’empreinte du modèle ; chaque fichier exporté donne les deux.",
    theme: "Thème",
    themeAuto: "comme le système",
    themeLight: "clair",
    themeDark: "sombre",
    language: "Langue",
    takeTour: "Faire la visite",
  },

  quantities: {
    axial_length: "Longueur axiale",
    half_width: "Demi-largeur",
    half_diagonal: "Demi-diagonale",
    rear_depth: "Creux arrière",
    velocity: "Vitesse",
    volume: "Volume",
    expected_error: "Erreur attendue",
    error_bound: "Borne d’erreur à 95 %",
  },
  readouts: {
    group: "Grandeurs ; celle qui est choisie est tracée dans le temps",
    groupExtrapolated: "Valeurs extrapolées. Grandeurs ; celle qui est choisie est tracée dans le temps",
    guess: (name) => `${name}, estimation grossière`,
    none: "aucune",
    noAnswer: (name) => `${name} : pas de réponse`,
    announced: (query, t, figures, against) => `${query}, temps ${t} : ${figures} ; erreurs ${against}`,
    announcedExtrapolated: (words) => `Valeurs extrapolées. ${words}`,
  },
  errors: {
    againstModel: (law, bending) => `par rapport au modèle complet (membrane ${law}${bending})`,
    againstData: "par rapport aux données dont le modèle est issu",
    ofCapsule: "distance de Hausdorff modifiée, dérive le long du canal comprise, en pour cent de a",
    ofNodes: "distance moyenne des nœuds, en pour cent de a, rayon de la sphère de même volume que la capsule",
    sentence: (against, distance) => `Les erreurs sont prises ${against} : ${distance}.`,
  },
  fields: {
    displacement: "Déplacement",
    velocity: "Vitesse",
    stretch_1: "Élongation λ₁",
    stretch_2: "Élongation λ₂",
    tension_1: "Tension T₁",
    tension_2: "Tension T₂",
    energy_density: "Densité d’énergie",
    load: "Charge",
    inLaboratory: (name) => `${name} dans le référentiel du laboratoire`,
    toCentroid: (name) => `${name} par rapport au barycentre`,
    colours: (name, least, most) => `Couleurs : ${name}, de ${least} à ${most}`,
  },
  laws: { "neo-Hookean": "néo-hookéenne" },

  card: {
    samples: "Échantillons",
    membrane: "Membrane",
    size: "Taille",
    licences: "Licences",
    thirdParty: "tierces",
    origin: (title, database, day) => `${title}. Base de données ${database}, modèle du ${day}`,
    samplesHint: "Simulations du modèle complet dont le modèle est issu",
    membraneHint: "Loi de comportement de la membrane",
    megabytes: (size) => `${size} Mo`,
    sizeHint: (nodes) => `${nodes} nœuds sur la membrane`,
  },
  link: {
    copied: "Copié",
    byHand: "À copier depuis la barre d’adresse",
    ofModel: (digest) => `le modèle ${digest}`,
    ofFile: (file, digest) => `${file} (modèle ${digest})`,
    isOther: (wanted, digest) =>
      `Ce lien a été créé avec ${wanted}. Le modèle ouvert est ${digest} : ses valeurs peuvent différer.`,
    openFile: "Ouvrir ce fichier…",
    goOn: "Continuer avec ce modèle",
  },
  refusals: {
    core: {
      capacity: (required, limit, capacity) => `le modèle compte ${required} ${limit}, la mémoire en tient ${capacity}`,
      value: (what, value, min, max) => `${VALUES[what] ?? what} vaut ${value} : attendu entre ${min} et ${max}`,
      "parameter-count": (expected, found) => `le modèle a ${expected} paramètres, la requête ${found}`,
      parameter: (name, value, min, max) => `${parameter(name)} vaut ${value} : attendu entre ${min} et ${max}`,
      "unknown-parameter": (index, count) =>
        `le paramètre ${index}, compté à partir de 0, n’existe pas : le modèle en a ${count}`,
      "no-derivatives": () => "les dérivées sont celles de la méthode directe : la choisir",
      "outside-domain": (name, value, min, max) =>
        `${parameter(name)} = ${value} sort du domaine échantillonné, de ${min} à ${max}`,
      "far-from-samples": (ratio) =>
        `aucun échantillon n’est proche : l’interpolation est ${ratio} fois plus incertaine qu’en tout échantillon ` +
        "laissé de côté",
      "beyond-extrapolation": (distance, limit) =>
        `la requête se trouve à ${distance} étendues de ses échantillons ; la limite est ${limit}`,
      "beyond-steady-limit": (ca, confinement, limit) =>
        `pas d’état stationnaire à Ca = ${ca}, a/ℓ = ${confinement} : la limite y est Ca = ${limit}`,
      "no-bound": () =>
        "aucune borne de l’erreur n’est connue hors du domaine échantillonné : la réponse est extrapolée",
      "wrong-volume": (volume, min, max) =>
        `aucune capsule n’a la forme extrapolée : son volume vaut ${volume} fois celui d’une sphère de rayon a, ` +
        `attendu entre ${min} et ${max} ; rester plus près du domaine échantillonné`,
      "beyond-wall": (reach) =>
        `aucune capsule n’a la forme extrapolée : un nœud se trouve à ${reach} de l’axe, au-delà de la paroi à 1 ; ` +
        "rester plus près du domaine échantillonné",
      weights: (sum) =>
        "les échantillons proches de la requête sont trop serrés : la somme de leurs poids vaut " +
        `${sum} au lieu de 1`,
      "not-prepared": () => "un instant est demandé avant toute requête",
      "unknown-node": (node, nodes) => `le nœud ${node} n’existe pas : le maillage en a ${nodes}`,
      "unsupported-reference": () =>
        "la mécanique de la membrane n’est connue que pour la loi néo-hookéenne et un état sans contrainte " +
        "sphérique, de rayon a/ℓ",
      "stencil-too-small": (node) =>
        `les nœuds autour du nœud ${node} ne déterminent pas de dérivées : le maillage est trop grossier`,
      "unknown-node-set": () => "le modèle n’a pas d’ensemble de nœuds de ce nom",
      "buffer-too-short": (found, required) => `le tampon tient ${found} valeurs, il en faut ${required}`,
      "not-finite": () => "le résultat n’est pas fini : les paramètres sont trop loin de tous les échantillons",
      "unknown-name": (kind, name, known) => `${kind} : « ${name} » est inconnu ; sont connus ${known}`,

      truncated: (expected, found) => `le fichier est tronqué : ${expected} octets attendus, ${found} trouvés`,
      magic: (found) => `ce n’est pas un fichier de modèle : il commence par ${found} au lieu de « CROM »`,
      version: (found, supported) =>
        Number(found) > Number(supported)
          ? `le fichier est au format ${found}, cette page connaît jusqu’à ${supported} : mettre la page à jour`
          : `le fichier est au format ${found}, cette page ne connaît que le ${supported} : reconstruire le modèle`,
      checksum: (expected, found) => `le fichier est endommagé : CRC-32 ${expected} attendu, ${found} trouvé`,
      undecodable: () => "le contenu du fichier ne se lit pas selon son format",
      "trailing-bytes": (found) => `${found} octets suivent la fin du contenu`,
      rows: (what, expected, found) => `${what} : ${expected} lignes attendues, ${found} trouvées`,
      columns: (what, expected, found) => `${what} : ${expected} colonnes attendues, ${found} trouvées`,
      dimension: (what, expected, found) => `${what} : ${expected} attendus, ${found} trouvés`,
      length: (what, expected, found) =>
        `${what} : ${expected} octets attendus d’après les dimensions, ${found} trouvés`,
      index: (what, index, value, bound) =>
        `${what} : l’élément ${index} vaut ${value}, attendu au-dessous de ${bound}`,
      number: (what, index, value, expected) => `${what} : l’élément ${index} vaut ${value}, attendu : ${expected}`,
      setting: (what, value, min, max) => `${what} vaut ${value} : attendu entre ${min} et ${max}`,
      "no-image": (node) => `le nœud ${node} n’est pas à sa place parmi les images du secteur`,
      "short-outline": (name) => `l’ensemble de nœuds « ${name} » a moins de 3 nœuds`,
      "duplicate-sample": (first, second) =>
        `les échantillons ${first} et ${second} d’un groupe ont les mêmes paramètres`,

      "text-empty": () =>
        "aucune ligne n’a deux nombres : les coordonnées des points sont attendues, un point par ligne",
      "text-number": (line, cell) => `ligne ${line} : « ${cell} » n’est pas un nombre`,
      "text-columns": (width, names) =>
        `le texte a ${width} colonnes${names === "" ? "" : ` (${names})`} : il en faut deux, ou des titres qui ` +
        "commencent par x et y",
      "text-units": (named, given) =>
        `les titres indiquent ${UNITS[named] ?? named} et l’unité donnée est ${UNITS[given] ?? given} : l’un des ` +
        "deux est faux",
      "text-unit": () => "l’unité des nombres n’est pas connue : indiquer que ce sont des µm, ou la taille d’un pixel",
      "text-scale": () => "les nombres sont en pixels : donner la taille d’un pixel",
      "picture-unreadable": (cause) => `l’image ne se lit ni en PNG, ni en JPEG, ni en TIFF : ${cause}`,
      "picture-small": (width, height, least) =>
        `l’image a ${width} x ${height} pixels : il en faut au moins ${least} de chaque côté`,
      "picture-empty": (least) =>
        `aucune capsule n’est visible : rien d’au moins ${least} pixels de large ne se détache du fond`,
      "picture-border": () => "la capsule touche le bord de l’image : tout le contour doit être visible",
      "picture-ends": () =>
        "les deux bouts du canal diffèrent, comme si une capsule y touchait le bord de l’image : recadrer sur une " +
        "seule capsule entière, avec du canal vide des deux côtés",
      "picture-capsules": (count, places) =>
        `l’image montre ${count} capsule(s) entière(s), aux pixels ${places} : en choisir une par son numéro, de 1 à ` +
        count,
      "picture-scale": () => "les parois ne sont pas visibles des deux côtés : donner la taille d’un pixel",
      "contour-short": (found, least) =>
        `le contour a ${found} points : il en faut au moins ${least}, tout autour de la capsule`,
      "contour-long": (found, most) => `le contour a ${found} points, au plus ${most} sont pris`,
      "contour-number": (point) => `le point ${point} du contour n’est pas un nombre fini`,
      "contour-crossing": (first, second) =>
        `le contour se croise, après ses points ${first} et ${second} : les points doivent se suivre autour de la ` +
        "capsule, une seule fois",
      "contour-wide": (width, channel) =>
        `le contour a ${width} µm de large, le canal ${channel} µm : l’échelle, l’unité ou le demi-côté est faux`,
      "contour-open": (share, most) =>
        `le contour laisse ouverts ${share} % du tour : il peut en manquer au plus ${most} %`,
      "contour-area": () => "le contour n’entoure aucune surface : ce n’est pas celui d’une capsule",
      setup: (words) => `les données de l’expérience ne se lisent pas : ${words}`,
      "setup-velocities": () =>
        "donner une seule des vitesses : velocity_mm_s, flow_rate_ul_min ou capsule_velocity_mm_s",
      "setup-pixel": (size) => `la taille d’un pixel vaut ${size} µm : un nombre positif est attendu`,
      "setup-number": (what, value) => `${what} vaut ${value} : un nombre positif et fini est attendu`,
      "no-fit": () => "aucune capsule du modèle n’approche le contour",
      "no-answer": () => "il n’y a pas encore de réponse dont l’écart serait à donner",
      measurement: (words) => `le contour n’est pas accepté : ${words}`,
    },
    isOutline: (file) =>
      `${file} n’est pas un modèle, et le modèle ouvert n’accepte pas de contours : ce n’est pas celui d’une capsule ` +
      "dans le canal.",
    openChannel: "Ouvrir un fichier .crom, ou d’abord un modèle de capsules dans le canal.",
    noProgram: (cause) => `Le programme de la page n’a pas pu être chargé : ${cause}.`,
    loadAgain: "Vérifier que le serveur fonctionne encore, puis recharger la page.",
    unread: (file, cause) => `${file} n’a pas pu être lu : ${cause}.`,
    openReadable: "Ouvrir un fichier, et non un dossier, dont la lecture est permise.",
    elsewhere: (address) => `Le modèle ${address} se trouve sur un autre serveur.`,
    putBeside: "Le placer à côté de cette page, ou le télécharger et l’ouvrir depuis le disque.",
    unfetched: (file, cause) => `Le modèle ${file} n’a pas pu être téléchargé : ${cause}.`,
    missing: (file, status, path) => `Le modèle ${file} est introuvable : le serveur a répondu ${status} pour ${path}.`,
    buildPage:
      "Construire la page avec `cargo xtask explore`, qui place le modèle à côté d’elle, ou ouvrir un fichier .crom " +
      "depuis le disque.",
    noModel: (file, cause) => `${file} n’est pas un modèle lisible : ${cause}.`,
    noMagic: "il ne commence pas par CROM",
    truncated: "il est tronqué",
    tooShort: (size, stated) => `il est tronqué, ${size} octets sur ${stated}`,
    tooLong: (size, stated) => `il est trop long, ${size} octets au lieu de ${stated}`,
    openModel: "Ouvrir un fichier .crom écrit par `capsule-rom offline build`, ou copier celui-ci à nouveau.",
    noSession: (file) => `${file} n’est pas une session lisible.`,
    openSession: "Ouvrir un fichier enregistré par Exporter, Session sur cette page, ou un modèle .crom.",
    noStart: (cause) => `La page n’a pas pu démarrer : ${cause}.`,
    startAgain: "Recharger la page ; si cela ne suffit pas, la construire avec `cargo xtask explore`.",
    goBack: "Revenir au modèle ouvert",
  },
  notice: {
    extrapolated: (where) =>
      `Valeurs extrapolées : ces paramètres se trouvent ${where}. L’erreur attendue est une estimation grossière, ` +
      "aucune borne n’est connue.",
    where: {
      outside: "hors du domaine échantillonné",
      "far-from-samples": "loin de tous les échantillons",
      "beyond-steady-limit": "au-delà du plus grand Ca stationnaire",
    },
    noAnswerAt: (t) => `Pas de réponse à t = ${t} : `,
    extrapolate: "Extrapoler",
    nearest: (place) => `Aller au point intérieur le plus proche, ${place}`,
  },

  views: {
    figures: "Vues de la capsule",
    figuresExtrapolated: "Vues de la capsule, extrapolées",
    figuresRefused: "Vues de la capsule : aucune forme à montrer",
    toggles: {
      solid: "3D",
      midplane: "z = 0",
      diagonal: "y = z",
      transversal: "x = c",
      plots: "Courbes",
      measured: "Contour",
    },
    sectionZ: "Coupe de la capsule par le plan z = 0",
    sectionYZ: "Coupe de la capsule par le plan diagonal y = z",
    sectionAcross: "Coupe de la capsule en travers du canal",
    missed: "Le plan ne coupe pas la capsule.",
    along: { time: "dans le temps", ca: "selon Ca, stationnaire", confinement: "selon a/ℓ, stationnaire" },
    curve: (name, along, span) => `${name} ${along} : ${span}`,
    noValues: "aucune valeur",
    span: (least, most, unit) => `de ${least} à ${most} ${unit}`,
  },
  space: {
    canvas: "Capsule dans le canal, en 3D. Glisser ou utiliser les flèches pour tourner, + et − pour zoomer.",
    live: "Courante",
    colours: { none: "Unie" },
    clips: { none: "Entière", y: "Coupée en y = 0", z: "Coupée en z = 0" },
    cameras: { oblique: "Oblique", side: "Côté", front: "Face" },
    look: (key) => `Regarder de là (${key})`,
    lost: "Le navigateur a retiré la carte graphique à cette vue.",
    noWebGl:
      "Cette vue utilise WebGL, que ce navigateur n’offre pas. Les coupes et toutes les valeurs restent " +
      "disponibles ; pour voir la capsule en 3D, activer l’accélération matérielle ou utiliser un autre navigateur.",
    startAgain: "Relancer la vue 3D",
  },
  map: {
    name: "Carte du domaine des paramètres",
    point: "Nombre capillaire et confinement ; les flèches déplacent le point, avec Maj plus finement",
    steadyLimit: "plus grand Ca stationnaire",
    jump: "saut",
    unsteady: "pas d’état stationnaire",
    before: (t) => `avant t = ${t}`,
    noAnswer: "pas de réponse",
    bestFit: (verdict) => `meilleur ajustement : ${verdict}`,
    layers: { none: "Sans niveaux", misfit: "Écart" },
    contours: (quantity, t, unit, against) => `Lignes de niveau : ${quantity} à t = ${t}, en ${unit}${against}`,
    misfitContours: (known) =>
      `Lignes de niveau : écart au contour mesuré, en écarts-types${known} ; régions à 68 et 95 %`,
    computed: (percent) => `, ${percent} % calculés`,
    noOutline: "Aucun contour n’est encore identifié",
  },
  time: {
    pause: "Pause",
    name: (unit) => `Temps, en ${unit}`,
    ends: (last) => `Le modèle s’arrête à ${last} : c’est cet instant`,
    extrapolated: (name) => `Extrapolation : ${name}`,
    none: (name) => `${name} : aucune valeur`,
    listen: (name) => `Écouter ${name} dans le temps`,
  },
  sliders: { value: (name) => `${name}, valeur` },

  units: {
    side: "Côté du canal",
    viscosity: "Viscosité du liquide",
    modulus: "Module de cisaillement surfacique",
    radius: "Rayon de la capsule",
    velocity: "Vitesse moyenne",
    rate: "Débit",
  },
  compare: {
    readout: "Grandeur",
    live: "Courante",
    distance: "Distance des formes",
    note: (against) =>
      "Petits chiffres : courante moins épinglée. Distance : distance de Hausdorff modifiée entre tous les nœuds, " +
      `dans le référentiel du laboratoire, rapportée à la plus grande des deux bornes à 95 % ${against}.`,
    makeLive: (name) => `Faire de ${name} la requête courante`,
    remove: (name) => `Retirer ${name}`,
    same: (distance) => `${distance} : la même forme`,
    noBound: (distance) => `${distance} : pas de borne pour comparer`,
    notResolved: (distance) => `${distance} : non résolue`,
    times: (distance, times) => `${distance} : ${times} fois l’erreur`,
  },
  outline: {
    use: "Choisir des points en texte ou une image (PNG, JPEG, TIFF), les déposer sur la page, ou les coller.",
    square:
      "Une image ne distingue pas un canal carré d’un tube cylindrique : dans un tube, les valeurs seraient fausses.",
    choose: "Choisir un fichier…",
    halfWidth: "Demi-côté du canal ℓ, µm",
    meanVelocity: "Vitesse moyenne V, mm/s",
    rate: "Débit 4ℓ²V, µl/min",
    viscosity: "Viscosité, Pa s",
    pixel: "Taille d’un pixel, µm",
    byWalls: "par les parois",
    number: "Numéro de la capsule",
    onlyOne: "la seule",
    observable: "Le contour est",
    observables: { midplane: "la coupe z = 0", silhouette: "la silhouette" },
    unit: "Unité d’un texte",
    outlineUnits: { named: "celle du texte", um: "µm", px: "pixels" },
    flow: "Sens de l’écoulement",
    flows: {
      found: "trouvé par l’ajustement",
      right: "vers la droite",
      left: "vers la gauche",
      up: "vers le haut",
      down: "vers le bas",
    },
    needed: (missing) => `Il manque encore : ${missing}.`,
    neededHalfWidth: "le demi-côté du canal",
    neededVelocity: "la vitesse moyenne ou le débit",
    neededViscosity: "la viscosité",
    busy: "Identification…",
    programFailed: (cause) => `Le programme d’identification a échoué : ${cause}`,
    notLoaded: "il n’a pas pu être chargé ; vérifier que le serveur fonctionne encore",
    verdicts: {
      identified: ["identifiée", "une seule réponse, avec des intervalles fermés"],
      "bounded-on-one-side": [
        "bornée d’un côté",
        "l’intervalle atteint le bord du domaine échantillonné, au-delà duquel rien n’est connu : c’est une borne",
      ],
      "several-solutions": [
        "plusieurs solutions",
        "une autre capsule s’ajuste aussi bien, au-delà de la limite où l’arrière se creuse : mesurer aussi le creux " +
          "arrière, le rayon ou la vitesse",
      ],
      "outside-domain": [
        "hors du domaine",
        "le meilleur ajustement est au bord du domaine échantillonné et les données demandent plus : ces valeurs ne " +
          "sont pas une réponse",
      ],
      undetermined: ["indéterminée", "les données ne déterminent pas Ca et a/l : mesurer davantage"],
      "not-such-a-capsule": [
        "pas une telle capsule",
        "le contour s’écarte de celui de toute capsule du modèle, sur l’axe d’un canal carré, de plus que " +
          "son bruit et l’erreur du modèle : ces valeurs ne sont pas une réponse",
      ],
      "scale-or-channel-inconsistent": [
        "échelle ou canal incohérents",
        "l’échelle ou le bord devraient être faux de trois écarts-types : vérifier l’échelle, le demi-côté et le seuil",
      ],
    },
    verdict: (name, meaning) => `${name} : ${meaning}`,
    onScreen: (misfit) => `La capsule affichée : ${misfit}`,
    misfitPending: "écart …",
    misfitOutside: "hors du domaine, pas d’écart",
    misfit: (value) => `écart de ${value} écarts-types`,
    alternative: (place, rise) => `Autre solution : ${place}, χ² plus grand de ${rise}.`,
    warning: "Attention : ",
    show: "Montrer cette capsule",
    answerAs: (format) => `Réponse, ${format}`,
    remove: "Retirer",
    title: (file) => `Contour mesuré ${file}`,
    details: (flow, residuals, edge, scale, tilt, chi, freedom) =>
      `écoulement ${flow} ; résidus ${residuals} µm, bord ${edge} µm ; échelle ${scale} %, inclinaison ${tilt}° ; ` +
      `χ² ${chi} pour ${freedom}`,
    ofModel: (digest) => `modèle ${digest}`,
    foot: (digest, line) => `Modèle ${digest} ; ${line}`,
    open: "ouvert",
    interval: (low, high) => `de ${low} à ${high}`,
    quantity: "grandeur",
    value: "valeur",
    fit: "Points mesurés et contour ajusté",
    fitKey: "points : mesure ; trait : ajustement",
    regions: "Régions de Ca et a/l qui contiennent la vraie capsule à 68 et 95 pour cent",
    regionsKey: "a/ℓ : régions à 68 et 95 %",
    region: (share) => `Région qui contient la vraie capsule à ${share}`,
  },
  export: {
    map: "Carte des paramètres",
    track: "Grandeur dans le temps",
    whole: "Le tout en une page",
    numbers: "Grandeurs, à cet instant et dans le temps",
    surface: (unit) => `Surface, longueurs en ${unit}`,
    session: "Session, pour la rouvrir",
    save: "Enregistrer",
    moving: (name) => `${name}, en mouvement`,
    movingGlb: "GLB, en mouvement",
    closed: "la fenêtre a été fermée",
    noShape: "il n’y a aucune forme à montrer",
    noFilm: (cause) => `Pas de film : ${cause}.`,
    noCodecs: "Ce navigateur n’a pas WebCodecs pour encoder une vidéo.",
    asFormat: (name, format) => `${name}, ${format}`,
    figures: "Figures",
    noAnswer: "pas de réponse",
  },
  provenance: {
    model: (digest, title) => `CapsuleExplorer, modèle ${digest} : ${title}`,
    methods: { direct: "méthode directe", paper: "méthode de l’article" },
    refused: (query) => `${query} : pas de réponse`,
    extrapolated: "extrapolé",
    bound: (bound) => `borne d’erreur à 95 % ${bound}`,
    method: (citation) => `Méthode : ${citation}`,
    foot: (digest, query, against) => `Modèle ${digest} ; ${query} ${against}`,
  },

  tour: {
    count: (step, of) => `${step} sur ${of}`,
    done: "Terminer",
    steps: [
      {
        title: "Deux nombres déterminent le mouvement",
        words: `<p>Le nombre capillaire <i class="symbol">Ca</i> = <i class="symbol">μV</i>/<i
          class="symbol">G</i><sub>s</sub> compare les forces visqueuses aux forces élastiques : plus il est grand, plus
          la capsule se déforme. Le confinement <i class="symbol">a/ℓ</i> est le rapport de son rayon au demi-côté du
          canal.</p>
          <p>Les saisir, ou déplacer le point sur la carte. <b>Unités…</b> les calcule à partir des dimensions d’une
          expérience.</p>`,
      },
      {
        title: "Deux méthodes sur les mêmes données",
        words: `<p>La méthode <b>directe</b> interpole le mouvement lui-même, à tout instant. Celle de
          l’<b>article</b> avance pas à pas, comme dans la publication. L’erreur affichée indique laquelle est la plus
          proche du modèle complet.</p>
          <p>Les formes sont vues du laboratoire, ou du barycentre de la capsule.</p>`,
      },
      {
        title: "Une capsule, vue et coupée",
        words: `<p>Chaque plan a sa couleur, en 3D et dans sa coupe. La membrane peut montrer sa tension, son
          élongation, son énergie, sa charge ou son mouvement, et s’ouvre pour laisser voir l’intérieur. La bande autour
          d’un contour a la largeur de la borne d’erreur.</p>`,
      },
      {
        title: "Des valeurs, et leur fiabilité",
        words: `<p>En choisir une pour la tracer dans le temps. 95 % des erreurs sont inférieures à la borne ; « ≈ »
          signale les valeurs dont la borne est grande ou inconnue. <b>Épingler</b> garde une requête pour la comparer
          à d’autres.</p>`,
      },
      {
        title: "N’importe quel instant, aussitôt",
        words: `<p>Lancer la lecture, déplacer le repère ou saisir un instant : chacun est calculé directement, dans
          cette page, quand on le demande. Les boutons à côté affichent et masquent les vues.</p>`,
      },
      {
        title: "D’où viennent les données, et comment citer",
        words: `<p>Le modèle contient des simulations d’un modèle complet, les points de la carte : intégrales de
          frontière pour l’écoulement, éléments finis pour la membrane. Son empreinte le désigne dans chaque lien et
          chaque fichier.</p>
          <p>Citer Boubehziz et al., <cite>Entropy</cite> 2021, 23, 1193, et capsule-rom avec l’empreinte ; chaque
          fichier exporté donne les deux.</p>`,
      },
    ],
  },
};
